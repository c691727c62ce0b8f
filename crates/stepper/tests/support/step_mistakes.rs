//! Deliberate mistakes in the stepper's open–close iteration and step control, one at a time.

use Mistake::*;
use rockproof_stepper::Real;
use rockproof_stepper::contact::{ContactRules, SpecRules};
use rockproof_stepper::dynamics::{Mode, StepRules, TangentialState};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

macro_rules! mistakes {
    ($($name:ident $what:literal,)*) => {
        /// What can be wrong.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Mistake { $($name),* }

        pub(crate) const ALL: &[(Mistake, &str)] = &[$(($name, $what)),*];
    };
}

mistakes! {
    Nothing "none",
    SlidingLockedIgnored "convergence ignores changes between sliding and locked",
    RelockForgets "becoming locked ignores the stiffness ratio and cohesion, staying locked uses them",
    ThreeChanging "the third solve in which a mode changes ends the attempt",
    FiveChanging "the fifth solve in which a mode changes ends the attempt",
    SevenChanging "the seventh solve in which a mode changes ends the attempt",
    SlipsCountAlike "the sixth solve in which a mode changes ends the attempt where contacts only lock or slide as well",
    SlipsTurnedRound "the sixth solve in which a mode changes ends the attempt where contacts only lock or slide, else the twelfth",
    ElevenSlipping "the eleventh solve in which a mode changes ends the attempt where contacts only lock or slide",
    ThirteenSlipping "the thirteenth solve in which a mode changes ends the attempt where contacts only lock or slide",
    SixUnchanging "the sixth solve in which no mode changes ends the iteration",
    EightUnchanging "the eighth solve in which no mode changes ends the iteration",
    ChangesByForceCount "a change between locked and sliding keeps the iteration from ending, however small its force",
    OpeningIgnored "a solve in which a contact opens or closes can end the iteration",
    AlwaysSettled "friction has always settled",
    NeverSettled "friction never settles",
    SettledTurnedRound "friction has settled where the misfit is large",
    SettledTenfold "friction has settled where the misfit is a tenth of the normal force",
    TurnedForgotten "a slip that turns goes on",
    TurnedOtherWay "a slip that does not turn locks",
    NoSpringAcross "no spring acts across the slip",
    StifferAcross "the spring across the slip is the stiffer of both",
    OuterDistance "contacts are recorded apart up to the penetration depth, overlapping up to the search distance",
    BeginsOpen "a contact that begins touching is open",
    BeginsLocked "every contact begins locked",
    ClosesAtOnce "an open contact closes at any overlap",
    OpensAtOnce "a closed contact opens at any gap",
    TensionForgotten "tensile strength is forgotten",
    CohesionForgotten "cohesion is forgotten",
    FrictionForgotten "friction is forgotten",
    PullPresses "a gap presses as an overlap does",
    EqualAbsolute "Eq. (1): absolute",
    EqualForgotten "Eq. (1) is forgotten",
    EqualHoldsTouching "Eq. (1) keeps the mode of a gap of 0 that stays 0",
    UnsquaredStrength "the squared force is compared with the strength itself",
    AnchorStays "the anchor of a sliding contact stays behind",
    MemoryLost "contacts forget mode and anchor",
    CutByHalf "an iteration that fails is cut by half",
    BeginsFull "a step begins with the full time step",
    GrowsTwofold "a step begins with up to twice the last time step",
    GrowsBeyondFull "a step begins with half as much again as the last time step, or with the full one if that is more",
    StepEnlarged "a step begins with four times the full time step",
    ContactsDropped "vertices near faces are no contacts",
    KeptForgotten "no contact is kept",
    KeptOpen "open contacts are kept, closed ones are not",
    NoDisplacementLimit "the displacement limit is forgotten",
    NoRotationLimit "the rotation limit is forgotten",
    DampingForgotten "damping is left out",
    DampingOfFullStep "damping takes the full time step, also where it is cut",
    RateOnce "the rate after a step is (2/Δt)·d",
}

/// Held by a test as long as it plants mistakes: one test at a time does.
pub(crate) static PLANTING: Mutex<()> = Mutex::new(());

/// The mistake that is planted. The stepper classifies in threads, so no thread can hold it.
static PLANTED: AtomicUsize = AtomicUsize::new(0);

/// Plants a mistake from now on.
pub(crate) fn plant(mistake: Mistake) {
    PLANTED.store(mistake as usize, Ordering::SeqCst);
}

fn planted(mistake: Mistake) -> bool {
    PLANTED.load(Ordering::SeqCst) == mistake as usize
}

/// SPEC's rules but for the mistake that is planted.
pub(crate) struct Mistaken;

impl ContactRules for Mistaken {
    fn vertex_face_near<R: Real>(gap: R, search: R) -> bool {
        gap <= if planted(OuterDistance) { R::from_f64(PENETRATION) } else { search } && !planted(ContactsDropped)
    }
    fn vertex_face_depth<R: Real>(gap: R, penetration: R) -> bool {
        gap >= -if planted(OuterDistance) { R::from_f64(SEARCH) } else { penetration }
    }
}

impl StepRules for Mistaken {
    fn begins<R: Real>(gap: R) -> Mode {
        let locked = (gap <= R::ZERO && !(planted(BeginsOpen) && gap >= R::ZERO)) || planted(BeginsLocked);
        if locked { Mode::Locked } else { Mode::Open }
    }
    fn keeps_mode<R: Real>(gap: R, gap_before: R, equal: R) -> bool {
        let limit = if planted(EqualAbsolute) { equal } else { equal * gap_before.abs() };
        let touching = gap_before.abs() <= R::ZERO && !planted(EqualHoldsTouching) && !planted(EqualAbsolute);
        gap.abs() <= limit && !touching && !planted(EqualForgotten)
    }
    fn closes<R: Real>(gap: R, close: R) -> bool {
        gap < if planted(ClosesAtOnce) { R::ZERO } else { -close }
    }
    fn opens<R: Real>(gap: R, open: R, tensile_gap: R) -> bool {
        let open = if planted(OpensAtOnce) { R::ZERO } else { open };
        gap > if planted(TensionForgotten) { open } else { open + tensile_gap }
    }
    fn pressing<R: Real>(gap: R) -> R {
        if planted(PullPresses) { gap.abs() } else { (-gap).larger(R::ZERO) }
    }
    fn strength<R: Real>(friction: R, normal_force: R, cohesive_force: R) -> R {
        let cohesive = if planted(CohesionForgotten) { R::ZERO } else { cohesive_force };
        if planted(FrictionForgotten) { cohesive } else { friction * normal_force + cohesive }
    }
    fn locks<R: Real>(force_squared: R, strength_squared: R) -> bool {
        force_squared <= if planted(UnsquaredStrength) { strength_squared.sqrt() } else { strength_squared }
    }
    fn holds<R: Real>(before: Mode, slip: &TangentialState<R>) -> bool {
        if planted(RelockForgets) && before != Mode::Locked {
            let force = slip.normal * slip.normal * slip.stretch_squared;
            return Self::locks(force, slip.friction * slip.friction);
        }
        Self::locks(slip.shear * slip.shear * slip.stretch_squared, slip.strength * slip.strength)
    }
    fn counts_as_change(before: Mode, after: Mode) -> bool {
        before != after && !(planted(SlidingLockedIgnored) && before.is_closed() && after.is_closed())
    }
    fn changing_solves() -> u32 {
        match () {
            () if planted(ThreeChanging) => 3,
            () if planted(FiveChanging) => 5,
            () if planted(SevenChanging) => 7,
            () if planted(SlipsTurnedRound) => SpecRules::slipping_solves(),
            () => SpecRules::changing_solves(),
        }
    }
    fn slipping_solves() -> u32 {
        match () {
            () if planted(SlipsCountAlike) || planted(SlipsTurnedRound) => SpecRules::changing_solves(),
            () if planted(ElevenSlipping) => 11,
            () if planted(ThirteenSlipping) => 13,
            () => SpecRules::slipping_solves(),
        }
    }
    fn unchanging_solves() -> u32 {
        match () {
            () if planted(SixUnchanging) => 6,
            () if planted(EightUnchanging) => 8,
            () => SpecRules::unchanging_solves(),
        }
    }
    fn opens_or_closes(before: Mode, after: Mode) -> bool {
        match () {
            () if planted(ChangesByForceCount) => before != after,
            () if planted(OpeningIgnored) => false,
            () => SpecRules::opens_or_closes(before, after),
        }
    }
    fn settled<R: Real>(misfit: R, pressing: R) -> bool {
        match () {
            () if planted(AlwaysSettled) => true,
            () if planted(NeverSettled) => false,
            () if planted(SettledTurnedRound) => R::from_f64(100.0) * misfit >= pressing,
            () if planted(SettledTenfold) => R::from_f64(10.0) * misfit <= pressing,
            () => SpecRules::settled(misfit, pressing),
        }
    }
    fn slip_turned<R: Real>(along: R) -> bool {
        match () {
            () if planted(TurnedForgotten) => false,
            () if planted(TurnedOtherWay) => along > R::ZERO,
            () => SpecRules::slip_turned(along),
        }
    }
    fn spring_across<R: Real>(secant: R, shear: R) -> R {
        match () {
            () if planted(NoSpringAcross) => R::ZERO,
            () if planted(StifferAcross) => secant.larger(shear),
            () => SpecRules::spring_across(secant, shear),
        }
    }
    fn first_time_step<R: Real>(full: R, last: R) -> R {
        match () {
            () if planted(BeginsFull) => full,
            () if planted(GrowsTwofold) => full.smaller(last * R::from_f64(2.0)),
            () if planted(StepEnlarged) => full * R::from_f64(4.0),
            () if planted(GrowsBeyondFull) => full.larger(last * R::from_f64(1.5)),
            () => SpecRules::first_time_step(full, last),
        }
    }
    fn leaves_kept(mode: Mode) -> bool {
        match () {
            () if planted(KeptForgotten) => false,
            () if planted(KeptOpen) => !mode.is_closed(),
            () => SpecRules::leaves_kept(mode),
        }
    }
    fn cut<R: Real>(time_step: R) -> R {
        time_step * R::from_f64(if planted(CutByHalf) { 0.5 } else { 0.3 })
    }
    fn too_far<R: Real>(distance_squared: R, limit_squared: R) -> bool {
        distance_squared > limit_squared && !planted(NoDisplacementLimit)
    }
    fn turned_too_far<R: Real>(angle_squared: R, limit_squared: R) -> bool {
        angle_squared > limit_squared && !planted(NoRotationLimit)
    }
    fn drags_anchor() -> bool {
        !planted(AnchorStays)
    }
    fn transfers() -> bool {
        !planted(MemoryLost)
    }
    fn drag<R: Real>(damping: R, time_step: R, full: R) -> R {
        match () {
            () if planted(DampingForgotten) => R::ZERO,
            () if planted(DampingOfFullStep) => damping / full,
            () => SpecRules::drag(damping, time_step, full),
        }
    }
    fn rate<R: Real>(dynamic: R, twice_mean: R, before: R) -> R {
        if planted(RateOnce) { dynamic * twice_mean } else { dynamic * (twice_mean - before) }
    }
}

const SEARCH: f64 = 0.125;
const PENETRATION: f64 = 0.0625;
