//! A stepper with its rules, as something that classifies blocks.

use crate::contact::asked::asking;
use crate::contact::{
    ClassificationRequest, Collapsed, ContactRules, PreparedBlock, ToleranceOverflow, Tolerances, classify_with_kept,
};
use crate::lazy_wide::{LazyWide, noted};
use crate::real::Real;
use crate::wide::{Wide, count_unsettled, settled};
use rockproof_model::{Block, Contact, ContactKey, ExpectedContact, ToleranceSet, unexpected_contacts};
use std::marker::PhantomData;

/// Classifies a pair in each precision of the stepper, preparation included. Object safe, so that steppers with
/// different rules stand in one list.
pub trait Classifier: Send + Sync {
    /// The contacts in f32; coordinates and tolerances are rounded to it.
    ///
    /// # Errors
    /// When rounding collapses a block or a tolerance overflows.
    fn f32(&self, a: &Block, b: &Block, t: &ToleranceSet) -> Result<Vec<Contact>, EngineError>;

    /// The contacts in f64; coordinates and tolerances are rounded to it.
    ///
    /// # Errors
    /// When rounding collapses a block or a tolerance overflows.
    fn f64(&self, a: &Block, b: &Block, t: &ToleranceSet) -> Result<Vec<Contact>, EngineError>;

    /// The contacts in [`Wide`] and the number of comparisons that rounding left unsettled.
    ///
    /// # Errors
    /// When a block collapses.
    fn wide(&self, a: &Block, b: &Block, t: &ToleranceSet) -> Result<(Vec<Contact>, u64), EngineError>;
}

/// Why the stepper cannot classify a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EngineError {
    /// Rounding made it degenerate.
    #[error(transparent)]
    Collapsed(#[from] Collapsed),
    /// A tolerance is out of range.
    #[error(transparent)]
    Tolerance(#[from] ToleranceOverflow),
}

/// The stepper with the rules `M`: [`crate::contact::SpecRules`], or those with a deliberate mistake.
#[derive(Clone, Copy, Debug)]
pub struct Stepper<M> {
    rules: PhantomData<fn() -> M>,
}

impl<M> Stepper<M> {
    /// The stepper.
    #[must_use]
    pub const fn new() -> Self {
        Stepper { rules: PhantomData }
    }
}

impl<M> Default for Stepper<M> {
    fn default() -> Self {
        Stepper::new()
    }
}

impl<M: ContactRules> Classifier for Stepper<M> {
    fn f32(&self, a: &Block, b: &Block, t: &ToleranceSet) -> Result<Vec<Contact>, EngineError> {
        contacts_in::<f32, M>(a, b, t)
    }

    fn f64(&self, a: &Block, b: &Block, t: &ToleranceSet) -> Result<Vec<Contact>, EngineError> {
        contacts_in::<f64, M>(a, b, t)
    }

    fn wide(&self, a: &Block, b: &Block, t: &ToleranceSet) -> Result<(Vec<Contact>, u64), EngineError> {
        wide_contacts::<M>(a, b, t)
    }
}

/// Prepares and classifies a pair in one precision, where nothing is kept.
///
/// # Errors
/// When rounding collapses a block or a tolerance overflows.
pub fn contacts_in<R: Real, M: ContactRules>(
    a: &Block,
    b: &Block,
    t: &ToleranceSet,
) -> Result<Vec<Contact>, EngineError> {
    contacts_with_kept::<R, M>(a, b, t, &[])
}

/// The contacts of a pair in [`Wide`] by the rules `M`, preparation of both blocks included, and the number of unsettled
/// comparisons. Where that is 0, each decision is the exact one.
///
/// # Errors
/// When a block collapses; with exact coordinates of a canonical block it does not.
pub fn wide_contacts<M: ContactRules>(
    a: &Block,
    b: &Block,
    t: &ToleranceSet,
) -> Result<(Vec<Contact>, u64), EngineError> {
    let (contacts, unsettled) = count_unsettled(|| contacts_in::<Wide, M>(a, b, t));
    Ok((contacts?, unsettled))
}

/// The same contacts where every comparison is settled, so that each decision is the exact one; `None` where one is not, which is found out
/// sooner than by counting them all, and nearly all of them in f64.
///
/// # Errors
/// As [`wide_contacts`].
pub fn settled_contacts<M: ContactRules>(
    a: &Block,
    b: &Block,
    t: &ToleranceSet,
) -> Result<Option<Vec<Contact>>, EngineError> {
    let sooner = noted(|| settled(|| contacts_in::<LazyWide, M>(a, b, t)));
    sooner.unwrap_or_else(|| settled(|| contacts_in::<Wide, M>(a, b, t))).transpose()
}

/// Those of the contacts asked for that [`settled_contacts`] has otherwise than expected; none where a comparison is unsettled.
///
/// That is found out sooner than by all contacts: those asked for are tested first, by themselves. If a comparison of theirs is unsettled, so is
/// one of the whole. If they come out as expected and no exit can take them away, nothing departs, whatever becomes of the others.
///
/// # Errors
/// As [`wide_contacts`].
pub fn settled_departures<M: ContactRules>(
    a: &Block,
    b: &Block,
    t: &ToleranceSet,
    expected: &[ExpectedContact],
) -> Result<Vec<ContactKey>, EngineError> {
    let sooner = noted(|| settled(|| departures_in_turn::<M>(a, b, t, expected)));
    let all = || settled(|| Ok(unexpected_contacts(&contacts_in::<Wide, M>(a, b, t)?, expected)));
    sooner.unwrap_or_else(all).unwrap_or(Ok(Vec::new()))
}

fn departures_in_turn<M: ContactRules>(
    a: &Block,
    b: &Block,
    t: &ToleranceSet,
    expected: &[ExpectedContact],
) -> Result<Vec<ContactKey>, EngineError> {
    let (a, b, t) = (PreparedBlock::new(a)?, PreparedBlock::new(b)?, Tolerances::<LazyWide>::new(t)?);
    let classified =
        || M::contacts(ClassificationRequest::<LazyWide> { a: &a, b: &b, tolerances: &t, kept: &[], among: None });
    let alone = asking(expected.iter().map(|(key, _)| *key).collect(), classified);
    let is_as_expected = |(key, contact): &ExpectedContact| {
        let found = alone.iter().find(|found| found.contact.key == *key);
        found.map(|found| found.contact) == *contact && found.is_none_or(|found| !M::overlaps(found.gap))
    };
    if LazyWide::is_given_up() || expected.iter().all(is_as_expected) {
        return Ok(Vec::new());
    }
    let contacts: Vec<Contact> = classified().into_iter().map(|found| found.contact).collect();
    Ok(unexpected_contacts(&contacts, expected))
}

/// Prepares and classifies a pair in one precision, in a step in which the contacts `kept` go on whatever their depth.
///
/// # Errors
/// When rounding collapses a block or a tolerance overflows.
///
/// # Panics
/// When a kept contact names a feature that its block does not have.
pub fn contacts_with_kept<R: Real, M: ContactRules>(
    a: &Block,
    b: &Block,
    t: &ToleranceSet,
    kept: &[ContactKey],
) -> Result<Vec<Contact>, EngineError> {
    let (a, b, t) = (PreparedBlock::<R>::new(a)?, PreparedBlock::<R>::new(b)?, Tolerances::<R>::new(t)?);
    Ok(classify_with_kept::<R, M>(&a, &b, &t, kept).into_iter().map(|found| found.contact).collect())
}
