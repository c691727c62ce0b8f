//! Preparation and classification by the rules of SPEC, compiled in this crate once for each scalar.
//!
//! Generic code is compiled in every crate that uses it, and classification is used in nearly all. What goes through the functions of
//! [`CompiledContacts`] has no type parameter left. Other rules, those of tests, and other observers take the generic way.

use crate::contact::classify::{ClassificationRequest, ComputedContact};
use crate::contact::contact_rules::{ContactRules, SpecRules};
use crate::contact::prepared_block::{Collapsed, CollapsedPart, PreparedBlock};
use crate::contact::trace::{Trace, Unobserved};
use crate::double::Double;
use crate::lazy_wide::LazyWide;
use crate::real::Real;
use crate::vector::Vector;
use crate::wide::Wide;
use rockproof_model::decision::Decision;
use rockproof_model::{Block, VertexId};

/// Contacts, and the decisions made on the way with their outcomes.
pub(super) type TracedContacts<R> = (Vec<ComputedContact<R>>, Vec<(Decision, i8)>);

/// What classification does by the rules of SPEC in this scalar.
pub trait CompiledContacts: Sized {
    /// [`PreparedBlock::new`].
    ///
    /// # Errors
    /// As there.
    fn prepare(block: &Block) -> Result<PreparedBlock<Self>, Collapsed>;

    /// The contacts, watched by nobody.
    fn contacts(request: ClassificationRequest<'_, Self>) -> Vec<ComputedContact<Self>>;

    /// [`ClassificationRequest::traced`].
    fn traced(request: ClassificationRequest<'_, Self>) -> TracedContacts<Self>;
}

/// [`PreparedBlock::new`], the generic way.
fn prepare<R: Real>(block: &Block) -> Result<PreparedBlock<R>, Collapsed> {
    let mut prepared = PreparedBlock::unprepared(block.clone());
    for (v, exact) in block.vertices().iter().enumerate() {
        let near = |number| R::from_number(number).ok_or(Collapsed { what: CollapsedPart::Vertex(VertexId::at(v)) });
        prepared.place(Vector::new(near(&exact.x)?, near(&exact.y)?, near(&exact.z)?));
    }
    prepared.prepare()?;
    Ok(prepared)
}

/// The contacts by any rules, watched by nobody.
pub(super) fn contacts<R: Real, M: ContactRules>(request: ClassificationRequest<'_, R>) -> Vec<ComputedContact<R>> {
    request.observed::<M, _>(&mut Unobserved)
}

/// [`ClassificationRequest::traced`] by any rules.
pub(super) fn traced<R: Real, M: ContactRules>(request: ClassificationRequest<'_, R>) -> TracedContacts<R> {
    let mut trace = Trace::default();
    let found = request.observed::<M, _>(&mut trace);
    (found, trace.decisions)
}

macro_rules! compiled {
    ($($scalar:ty),*) => {$(
        impl CompiledContacts for $scalar {
            #[inline(never)]
            fn prepare(block: &Block) -> Result<PreparedBlock<Self>, Collapsed> {
                prepare(block)
            }

            #[inline(never)]
            fn contacts(request: ClassificationRequest<'_, Self>) -> Vec<ComputedContact<Self>> {
                contacts::<$scalar, SpecRules>(request)
            }

            #[inline(never)]
            fn traced(request: ClassificationRequest<'_, Self>) -> TracedContacts<Self> {
                traced::<$scalar, SpecRules>(request)
            }
        }
    )*};
}

compiled!(f32, f64, Double, Wide, LazyWide);
