//! Why an answer changed: the chain of SPEC section 6, link by link.
//!
//! For one pair and one tolerance set T the four answers O(exact input, ideal(T)), O(exact input, T), O(rounded input,
//! T) and F(rounded input, T) are compared neighbour with neighbour. A change is counted once, at the link where it
//! happens: tolerance, representation, arithmetic. So an error of an engine shows although a tolerance changed the same
//! contact before it, and although it happens to undo that change.

// Longer than 400 lines: one chain of causes, link after link.

use super::agreement::ChainSpan;
use super::agreement_record::{AgreementRecord, Compared};
use super::collapse::collapsed_feature;
use super::collision;
use super::compare::{AnswerChange, Difference, Features, differences};
use super::engine::{
    Answer, Engine, EngineFailure, ExactPair, ExactPrepared, Levels, Oracle, Prepared, Shortage, Trace, catch_panic,
};
use super::explain::{ChainLink, explain, nearest_decisions};
use super::external::protocol::completed;
use super::finding::{Cause, DecidingDecision, Finding, FindingScope};
use super::indexed_trace::IndexedTrace;
use super::metamorphic::{self, UnansweredCheck};
use super::separation_state::ReportedState;
use super::subject::{NamedSet, Subject};
use super::transform::ExactBlocks;
use rockproof_model::{Block, Contact, ExpectedContact, Precision, ToleranceSet};
use std::cell::{OnceCell, RefCell};
use std::rc::Rc;
use std::sync::Arc;

/// Who takes part in a campaign, and which checks are made.
pub struct EnginePanel {
    /// The exact side.
    pub oracle: Box<dyn Oracle>,
    /// The engines under examination.
    pub engines: Vec<Box<dyn Engine>>,
    /// One pair in this many goes through the metamorphic checks; 0 for none.
    pub metamorphic_every: u64,
}

impl EnginePanel {
    /// The precisions its engines use, f32 first.
    pub fn precisions(&self) -> Vec<Precision> {
        [Precision::F32, Precision::F64]
            .into_iter()
            .filter(|&p| self.engines.iter().any(|e| e.precision() == p))
            .collect()
    }

    /// Whether all engines could be asked so far.
    ///
    /// # Errors
    /// What this program lacked for one: then what that one said counts for nothing.
    pub fn check_shortage(&self) -> Result<(), Shortage> {
        self.engines.iter().find_map(|engine| engine.shortage()).map_or(Ok(()), |shortage| Err(shortage.clone()))
    }
}

/// What the examination of one pair brought.
#[derive(Debug, Default)]
pub struct PairExamination {
    /// The findings, by tolerance set, precision and cause.
    pub findings: Vec<Finding>,
    /// What each level of the oracle decided.
    pub levels: Levels,
    /// Contacts in the exact answers under the given tolerances.
    pub contacts: u64,
    /// Metamorphic checks made.
    pub metamorphic_checks: u64,
    /// How often the links of the chain agree.
    pub agreement: AgreementRecord,
}

/// Which findings somebody looks for; an examination for them may leave all others out.
#[derive(Clone, Copy, Debug)]
pub struct WantedFindings<'w> {
    /// The name of their cause.
    pub cause: &'w str,
    /// The name of what changed.
    pub change: &'w str,
    /// [`Difference::kinds`] of the difference; empty for any.
    pub kind: &'w str,
    /// The name of the predicate that decided, empty for none; `None` for any.
    pub predicate: Option<&'w str>,
    /// The name of the check whose changed pair had no usable answer; `None` for the pair as it stands.
    pub check: Option<&'w str>,
}

impl WantedFindings<'_> {
    fn is_at(&self, link: Cause) -> bool {
        let one_of = |causes: &[Cause]| causes.iter().any(|cause| cause.name() == self.cause);
        match link {
            Cause::Tolerance | Cause::Representation => one_of(&[link]),
            Cause::Arithmetic | Cause::Defect | Cause::Engine => {
                one_of(&[Cause::Arithmetic, Cause::Defect, Cause::Engine])
            }
        }
    }

    /// Whether a difference is such a one; a metamorphic check calls it by `change`.
    pub(super) fn includes(&self, change: AnswerChange, difference: &Difference) -> bool {
        change.name() == self.change && (self.kind.is_empty() || difference.kinds() == self.kind)
    }

    /// Whether the check of this name can bring such a one.
    pub(super) fn is_of_check(&self, check: AnswerChange) -> bool {
        self.check.unwrap_or(self.change) == check.name()
    }

    /// Whether a difference that this decided can be such a one.
    pub(super) fn includes_decided_by(&self, deciding: Option<&DecidingDecision>) -> bool {
        let name = deciding.map_or("", |deciding| deciding.decision.predicate.name());
        self.predicate.is_none_or(|predicate| predicate == name)
    }
}

/// Examines one pair under all its tolerance sets.
pub fn examine_pair(subject: &Subject, panel: &EnginePanel) -> PairExamination {
    examination(subject, panel, None)
}

/// The findings of one pair under all its tolerance sets, those wanted at least: what is not wanted is not explained.
pub fn findings_wanted<'p>(subject: &'p Subject, panel: &'p EnginePanel, wanted: WantedFindings<'p>) -> Vec<Finding> {
    examination(subject, panel, Some(wanted)).findings
}

fn examination<'p>(
    subject: &'p Subject,
    panel: &'p EnginePanel,
    wanted: Option<WantedFindings<'p>>,
) -> PairExamination {
    let rounded: Vec<RoundedPair<'_>> = panel.precisions().into_iter().map(|p| RoundedPair::new(subject, p)).collect();
    let prepared = panel.oracle.prepare(&subject.a, &subject.b);
    let exact = ExactSide::new(prepared.pair());
    let views: Vec<PrecisionView<'_, '_>> = rounded.iter().map(|r| PrecisionView::new(r, panel)).collect();
    let mut examination = Examiner {
        subject,
        panel,
        blocks: ExactBlocks::new([&subject.a, &subject.b]),
        features: Features { a: subject.a.topology(), b: subject.b.topology() },
        exact,
        found: PairExamination::default(),
        recorder: AgreementRecord::default(),
        wanted,
    };
    let (tolerance, later) = (examination.wants(Cause::Tolerance), !examination.wants_only(Cause::Tolerance));
    for (number, set) in subject.sets.iter().enumerate() {
        if tolerance {
            examination.tolerance_link(set, &views);
        }
        for view in views.iter().filter(|_| later) {
            examination.engine_links(set, number, view);
        }
    }
    let mut found = examination.found;
    found.agreement = examination.recorder;
    found.levels.add(&examination.exact.levels.into_inner());
    for view in views {
        if let Some(side) = view.exact.into_inner() {
            found.levels.add(&side.levels.into_inner());
        }
    }
    found
}

/// A pair as the engines of one precision see it.
struct RoundedPair<'o> {
    precision: Precision,
    /// The rounded blocks, or why there are none.
    blocks: Result<[Block; 2], String>,
    /// Whether rounding changed nothing.
    same: bool,
    /// What rounding destroyed.
    collapsed: Option<String>,
    /// The rounded blocks in the oracle.
    prepared: OnceCell<Box<dyn ExactPrepared + 'o>>,
}

impl RoundedPair<'_> {
    fn new(subject: &Subject, precision: Precision) -> Self {
        let same = subject.a.is_exact_in(precision) && subject.b.is_exact_in(precision);
        let blocks = if same {
            Ok([subject.a.clone(), subject.b.clone()])
        } else {
            let near = |name: &str, block: &Block| {
                block.rounded(precision).ok_or_else(|| format!("a coordinate of block {name} overflows in {precision}"))
            };
            near("A", &subject.a).and_then(|a| Ok([a, near("B", &subject.b)?]))
        };
        let collapsed = match &blocks {
            Ok([a, b]) if !same => collapsed_feature(a)
                .map(|what| format!("{what} in block A"))
                .or_else(|| collapsed_feature(b).map(|what| format!("{what} in block B"))),
            _ => None,
        };
        RoundedPair { precision, blocks, same, collapsed, prepared: OnceCell::new() }
    }
}

/// The oracle's side of a pair, with the answers already given.
pub(super) struct ExactSide<'p> {
    pair: Box<dyn ExactPair + 'p>,
    given: RefCell<Vec<(ToleranceSet, Rc<Vec<Contact>>)>>,
    traced: RefCell<Vec<(ToleranceSet, Rc<IndexedTrace>)>>,
    levels: RefCell<Levels>,
}

impl<'p> ExactSide<'p> {
    pub(super) fn new(pair: Box<dyn ExactPair + 'p>) -> Self {
        ExactSide { pair, given: RefCell::default(), traced: RefCell::default(), levels: RefCell::default() }
    }

    /// The exact contacts. Sets that differ only in what classification does not use share an answer.
    fn contacts(&self, tolerances: &ToleranceSet) -> Rc<Vec<Contact>> {
        if let Some((_, contacts)) = self.given.borrow().iter().find(|(t, _)| classify_alike(t, tolerances)) {
            return Rc::clone(contacts);
        }
        let answer = self.pair.classify(tolerances);
        self.levels.borrow_mut().add(&answer.levels);
        let contacts = Rc::new(answer.contacts);
        self.given.borrow_mut().push((tolerances.clone(), Rc::clone(&contacts)));
        contacts
    }

    /// The decisions behind them. Several links of the chain ask for those of one set.
    fn trace(&self, tolerances: &ToleranceSet) -> Rc<IndexedTrace> {
        if let Some((_, trace)) = self.traced.borrow().iter().find(|(t, _)| classify_alike(t, tolerances)) {
            return Rc::clone(trace);
        }
        let trace = Rc::new(self.pair.indexed_trace(tolerances));
        self.traced.borrow_mut().push((tolerances.clone(), Rc::clone(&trace)));
        trace
    }
}

/// Whether two sets are the same in everything classification uses.
fn classify_alike(one: &ToleranceSet, other: &ToleranceSet) -> bool {
    one.criteria == other.criteria
        && one.search == other.search
        && one.territory == other.territory
        && one.penetration == other.penetration
        && one.overlap_sine == other.overlap_sine
        && one.parallel_sine == other.parallel_sine
        && one.equal == other.equal
}

/// An engine with a pair inside, or why it could not take it.
type EngineView<'p> = (&'p dyn Engine, Result<Box<dyn Prepared + 'p>, EngineFailure>);

/// The engines of one precision with the rounded pair inside.
struct PrecisionView<'p, 'o> {
    rounded: &'p RoundedPair<'o>,
    oracle: &'o dyn Oracle,
    engines: Vec<EngineView<'p>>,
    exact: OnceCell<ExactSide<'p>>,
}

impl<'p, 'o: 'p> PrecisionView<'p, 'o> {
    fn new(rounded: &'p RoundedPair<'o>, panel: &'o EnginePanel) -> Self {
        let mut engines = Vec::new();
        if let (Ok([a, b]), None) = (&rounded.blocks, &rounded.collapsed) {
            for engine in panel.engines.iter().filter(|e| e.precision() == rounded.precision) {
                engines.push((&**engine, catch_panic(|| engine.prepare(a, b))));
            }
        }
        PrecisionView { rounded, oracle: &*panel.oracle, engines, exact: OnceCell::new() }
    }

    /// The oracle's side of the rounded pair.
    fn exact_side(&self, [a, b]: &'p [Block; 2]) -> &ExactSide<'p> {
        self.exact
            .get_or_init(|| ExactSide::new(self.rounded.prepared.get_or_init(|| self.oracle.prepare(a, b)).pair()))
    }
}

struct Examiner<'p> {
    subject: &'p Subject,
    panel: &'p EnginePanel,
    blocks: ExactBlocks<'p>,
    features: Features<'p>,
    exact: ExactSide<'p>,
    found: PairExamination,
    recorder: AgreementRecord,
    wanted: Option<WantedFindings<'p>>,
}

impl<'p> Examiner<'p> {
    /// Whether findings of a link of the chain are wanted.
    fn wants(&self, link: Cause) -> bool {
        self.wanted.is_none_or(|wanted| wanted.is_at(link))
    }

    fn wants_only(&self, link: Cause) -> bool {
        self.wanted.is_some_and(|wanted| wanted.is_at(link))
    }

    /// The differences that are wanted.
    fn wanted(&self, link: Cause, changed: Vec<Difference>) -> Vec<Difference> {
        let Some(wanted) = self.wanted else { return changed };
        let includes = |difference: &Difference| wanted.is_at(link) && wanted.includes(difference.change, difference);
        changed.into_iter().filter(includes).collect()
    }

    fn report(
        &mut self,
        set: &NamedSet,
        scope: FindingScope,
        cause: Cause,
        difference: Difference,
        deciding: Option<DecidingDecision>,
    ) {
        self.found.findings.push(Finding {
            index: self.subject.index,
            family: Arc::clone(&self.subject.family),
            form: Arc::clone(&self.subject.form),
            set: Arc::clone(&set.name),
            scope,
            cause,
            difference,
            deciding,
            comparison: None,
            note: None,
            check: None,
        });
    }

    fn report_failure(
        &mut self,
        set: &NamedSet,
        scope: FindingScope,
        cause: Cause,
        change: AnswerChange,
        note: String,
    ) {
        self.report(set, scope, cause, Difference { change, before: None, after: None }, None);
        if let Some(last) = self.found.findings.last_mut() {
            last.note = Some(note);
        }
    }

    /// Reports the changed pairs that an engine gave no usable answer to.
    fn report_unanswered(&mut self, at: &EngineAt<'_>, scope: &FindingScope, unanswered: Vec<UnansweredCheck>) {
        for UnansweredCheck { check, change, note } in unanswered {
            self.report_failure(at.set, scope.clone(), at.engine.cause(), change, note);
            if let Some(last) = self.found.findings.last_mut() {
                last.check = Some(check);
            }
        }
    }

    /// O(exact, ideal(T)) against O(exact, T). Where the sets of the precisions differ, what they have in common is
    /// reported once.
    fn tolerance_link(&mut self, set: &NamedSet, views: &[PrecisionView<'p, '_>]) {
        let precisions: Vec<Precision> = views.iter().map(|v| v.rounded.precision).collect();
        let mut sets: Vec<(FindingScope, &ToleranceSet)> = Vec::new();
        for &precision in &precisions {
            let scope = if precisions.len() == 1 { FindingScope::Any } else { FindingScope::Rounded(precision) };
            match sets.iter_mut().find(|(_, t)| classify_alike(t, set.of(precision))) {
                Some((shared, _)) => *shared = FindingScope::Any,
                None => sets.push((scope, set.of(precision))),
            }
        }
        for &precision in &precisions {
            let tolerances = set.of(precision);
            let (ideal, given) = (self.exact.contacts(&tolerances.ideal()), self.exact.contacts(tolerances));
            let compared = compared(self.subject, set, ChainSpan::Tolerance, precision.name());
            self.recorder.answers(&compared, &ideal, &given, self.features);
        }
        let mut changed: Vec<(FindingScope, &ToleranceSet, Difference)> = Vec::new();
        for (scope, tolerances) in &sets {
            let ideal = self.exact.contacts(&tolerances.ideal());
            let given = self.exact.contacts(tolerances);
            self.found.contacts += given.len() as u64;
            for difference in self.wanted(Cause::Tolerance, differences(&ideal, &given, self.features)) {
                match changed.iter_mut().find(|(_, _, known)| *known == difference) {
                    Some((shared, _, _)) => *shared = FindingScope::Any,
                    None => changed.push((scope.clone(), tolerances, difference)),
                }
            }
        }
        for (_, tolerances) in &sets {
            let here: Vec<(FindingScope, Difference)> = changed
                .iter()
                .filter(|(_, t, _)| std::ptr::eq(*t, *tolerances))
                .map(|(scope, _, difference)| (scope.clone(), *difference))
                .collect();
            if here.is_empty() {
                continue;
            }
            let only: Vec<Difference> = here.iter().map(|(_, d)| *d).collect();
            let link = ChainLink {
                before: &|| Some(self.exact.trace(&tolerances.ideal())),
                after: &|| Some(self.exact.trace(tolerances)),
                margins: &|decisions| self.exact.pair.margins(tolerances, decisions),
                roundoff: None,
            };
            let reasons = explain(&only, &link, self.features);
            for ((scope, difference), deciding) in here.into_iter().zip(reasons) {
                self.report(set, scope, Cause::Tolerance, difference, deciding);
            }
        }
    }

    /// O(exact, T) against O(rounded, T), and that against F(rounded, T) of each engine of one precision.
    fn engine_links(&mut self, set: &NamedSet, number: usize, view: &PrecisionView<'p, '_>) {
        let precision = view.rounded.precision;
        let given = set.of(precision);
        let mut lost = |change, note: String| {
            self.recorder.no_answer(&compared(self.subject, set, ChainSpan::Representation, precision.name()));
            for engine in self.panel.engines.iter().filter(|e| e.precision() == precision) {
                self.recorder.no_answer(&compared(self.subject, set, ChainSpan::Whole, engine.name()));
            }
            self.report_failure(set, FindingScope::Rounded(precision), Cause::Representation, change, note);
        };
        let blocks = match &view.rounded.blocks {
            Ok(blocks) => blocks,
            Err(note) => return lost(AnswerChange::Failure, note.clone()),
        };
        let tolerances = match given.rounded(precision) {
            Ok(tolerances) => tolerances,
            Err(name) => return lost(AnswerChange::Failure, format!("tolerance {name} overflows in {precision}")),
        };
        if let Some(what) = &view.rounded.collapsed {
            return lost(AnswerChange::Collapsed, what.clone());
        }
        let same = view.rounded.same && classify_alike(given, &tolerances);
        let exact = self.exact.contacts(given);
        let side = || if view.rounded.same { &self.exact } else { view.exact_side(blocks) };
        let rounded = if same { Rc::clone(&exact) } else { side().contacts(&tolerances) };
        let roundoff = Some(precision.epsilon() / 2.0);
        let represented = compared(self.subject, set, ChainSpan::Representation, precision.name());
        self.recorder.answers(&represented, &exact, &rounded, self.features);
        let changed = self.wanted(Cause::Representation, differences(&exact, &rounded, self.features));
        if !changed.is_empty() {
            let link = ChainLink {
                before: &|| Some(self.exact.trace(given)),
                after: &|| Some(side().trace(&tolerances)),
                margins: &|decisions| self.exact.pair.margins(given, decisions),
                roundoff,
            };
            let reasons = explain(&changed, &link, self.features);
            for (difference, deciding) in changed.into_iter().zip(reasons) {
                self.report(set, FindingScope::Rounded(precision), Cause::Representation, difference, deciding);
            }
        }
        if !self.wants(Cause::Arithmetic) {
            return;
        }
        for (engine, prepared) in &view.engines {
            let at = EngineAt {
                subject: self.subject,
                set,
                number,
                engine: *engine,
                blocks,
                tolerances: &tolerances,
                exact: &exact,
                rounded: &rounded,
            };
            let side = if view.rounded.same { None } else { Some(view.exact_side(blocks)) };
            self.arithmetic_link(&at, prepared, side);
        }
    }

    fn arithmetic_link(
        &mut self,
        at: &EngineAt<'_>,
        prepared: &Result<Box<dyn Prepared + 'p>, EngineFailure>,
        side: Option<&ExactSide<'p>>,
    ) {
        let scope = FindingScope::Engine(at.engine.name().into());
        let answer = match prepared {
            Ok(prepared) => catch_panic(|| prepared.answer(at.tolerances)).map(|answer| (prepared, answer)),
            Err(failure) => Err(failure.clone()),
        };
        let (prepared, said) = match answer {
            Ok((prepared, Answer::Contacts(contacts))) => (prepared, contacts),
            Ok((_, Answer::State(said))) => return self.state_link(at, &scope, said),
            Err(failure) => {
                self.recorder.no_answer(&at.compared(ChainSpan::Arithmetic));
                self.recorder.no_answer(&at.compared(ChainSpan::Whole));
                return self.report_failure(at.set, scope, at.engine.cause(), failure.change(), failure.to_string());
            }
        };
        let contacts = completed(said.clone(), at.rounded);
        self.recorder.answers(&at.compared(ChainSpan::Arithmetic), at.rounded, &contacts, self.features);
        let whole = completed(said.clone(), at.exact);
        self.recorder.answers(&at.compared(ChainSpan::Whole), at.exact, &whole, self.features);
        if contacts != **at.rounded {
            let changed = self.wanted(at.engine.cause(), differences(at.rounded, &contacts, self.features));
            self.report_arithmetic(at, changed, &**prepared, side);
        }
        if self.is_checked(at.number) {
            let base = metamorphic::MetamorphicBase {
                pair: &self.blocks,
                engine: at.engine,
                oracle: &*self.panel.oracle,
                blocks: at.blocks,
                tolerances: at.tolerances,
                exact: at.rounded,
                contacts: &said,
                prepared: &**prepared,
                wanted: self.wanted,
            };
            let checks = metamorphic::check(&base);
            self.found.metamorphic_checks += checks.made;
            for (cause, difference, deciding) in checks.violations {
                self.report(at.set, scope.clone(), cause, difference, deciding);
            }
            self.report_unanswered(at, &scope, checks.unanswered);
        }
    }

    /// Reports what an engine answers otherwise than the oracle.
    fn report_arithmetic(
        &mut self,
        at: &EngineAt<'_>,
        changed: Vec<Difference>,
        prepared: &(dyn Prepared + '_),
        side: Option<&ExactSide<'p>>,
    ) {
        let side = side.unwrap_or(&self.exact);
        if !changed.is_empty() {
            // Asked after what it costs less to know.
            let wide = OnceCell::new();
            let expected = expected(&changed, at.rounded);
            let in_wide = || catch_panic(|| Ok(prepared.departs_in_wide(at.tolerances, &expected))).ok().flatten();
            let link = ChainLink {
                before: &|| Some(side.trace(at.tolerances)),
                after: &|| engine_trace(prepared, at.tolerances).map(IndexedTrace::of).map(Rc::new),
                margins: &|decisions| side.pair.margins(at.tolerances, decisions),
                roundoff: Some(at.engine.precision().epsilon() / 2.0),
            };
            let outside = at.engine.cause() == Cause::Engine;
            let told = if outside { nearest_decisions } else { explain };
            let reasons = told(&changed, &link, self.features);
            for (difference, deciding) in changed.into_iter().zip(reasons) {
                if self.wanted.is_some_and(|wanted| !wanted.includes_decided_by(deciding.as_ref())) {
                    continue;
                }
                let departing = wide.get_or_init(in_wide).as_ref();
                let remains = departing.is_some_and(|departing| difference.keys().any(|key| departing.contains(&key)));
                let cause = if remains { Cause::Defect } else { at.engine.cause() };
                self.report(at.set, FindingScope::Engine(at.engine.name().into()), cause, difference, deciding);
            }
        }
    }

    /// Whether metamorphic checks are due under the set of this number: each checked pair is checked under one of its
    /// sets, in turn.
    fn is_checked(&self, number: usize) -> bool {
        let (every, index, sets) = (self.panel.metamorphic_every, self.subject.index, self.subject.sets.len() as u64);
        every > 0 && index.is_multiple_of(every) && (index / every) % sets == number as u64
    }

    /// The arithmetic link of an engine that says only how the blocks lie.
    fn state_link(&mut self, at: &EngineAt<'_>, scope: &FindingScope, said: ReportedState) {
        let pair = collision::CollisionCheck {
            engine: at.engine,
            exact: &self.blocks,
            blocks: at.blocks,
            tolerances: at.tolerances,
            metamorphic: self.is_checked(at.number),
        };
        let judgement = pair.judge(said);
        self.found.metamorphic_checks += judgement.made;
        if let Some(comparison) = &judgement.comparison {
            let right = judgement.wrong.iter().all(|(change, _)| change.is_metamorphic());
            self.recorder.state(&at.compared(ChainSpan::Arithmetic), comparison, right);
        }
        for (change, comparison) in judgement.wrong {
            let difference = Difference { change, before: None, after: None };
            self.report(at.set, scope.clone(), at.engine.cause(), difference, None);
            if let Some(last) = self.found.findings.last_mut() {
                last.comparison = Some(comparison);
            }
        }
        self.report_unanswered(at, scope, judgement.unanswered);
    }
}

/// One engine's place in the chain.
struct EngineAt<'x> {
    subject: &'x Subject,
    set: &'x NamedSet,
    number: usize,
    engine: &'x dyn Engine,
    blocks: &'x [Block; 2],
    tolerances: &'x ToleranceSet,
    exact: &'x Rc<Vec<Contact>>,
    rounded: &'x Rc<Vec<Contact>>,
}

impl EngineAt<'_> {
    fn compared(&self, span: ChainSpan) -> Compared<'_> {
        compared(self.subject, self.set, span, self.engine.name())
    }
}

fn compared<'x>(subject: &'x Subject, set: &'x NamedSet, span: ChainSpan, engine: &'x str) -> Compared<'x> {
    Compared { family: &subject.family, tolerances: &set.name, span, engine }
}

/// Whether two answers differ in the contacts a difference is about.
pub(super) fn answers_differ(one: &[Contact], other: &[Contact], about: &Difference) -> bool {
    about.keys().any(|key| Contact::find(one, key) != Contact::find(other, key))
}

/// What an exact answer has in the places of differences.
pub(super) fn expected(differences: &[Difference], exact: &[Contact]) -> Vec<ExpectedContact> {
    let keys = differences.iter().flat_map(Difference::keys);
    keys.map(|key| (key, Contact::find(exact, key))).collect()
}

/// The trace of an engine as a list, for callers that show it.
pub fn engine_trace(prepared: &dyn Prepared, tolerances: &ToleranceSet) -> Option<Trace> {
    catch_panic(|| Ok(prepared.trace(tolerances))).ok().flatten()
}
