//! A pair of the benchmark set at two places that hardly differ, ready for both codes.

use crate::Failure;
use parry3d_f64::math::{Pose, Vector as ParryVector};
use parry3d_f64::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d_f64::shape::ConvexPolyhedron;
use rockproof_model::{Block, BlockOptions, ContactKey, Number, ToleranceSet, Vec3, VertexId};
use rockproof_stepper::contact::{
    ClassificationRequest, ContactRules, NearbyFeatures, PreparedBlock, SpecRules, Tolerances,
};
use rockproof_stepper::dynamics::skin;
use rockproof_stepper::vector::Vector;
use serde_json::Value;

/// At how many places B is in turn.
pub const PLACES: usize = 2;
/// How far B goes, as a part of how far it may go before a step finds the features anew.
const SHARE_OF_SKIN: f64 = 1.0 / 1024.0;

/// A pair ready for both codes.
pub struct TimedPair {
    tolerances: Tolerances<f64>,
    a: PreparedBlock<f64>,
    b: [PreparedBlock<f64>; PLACES],
    points: [Vec<Vector<f64>>; PLACES],
    /// B once more, prepared again in the memory that it has.
    again: Option<PreparedBlock<f64>>,
    nearby: NearbyFeatures,
    shapes: [ConvexPolyhedron; 2],
    poses: [Pose; PLACES],
    manifold: ContactManifold<(), ()>,
}

/// A block with its f64 coordinates; `None` where it is none in f64.
fn block(value: &Value) -> Result<Block, Failure> {
    let vertices: Vec<[String; 3]> = serde_json::from_value(value["vertices"].clone())?;
    let faces: Vec<Vec<u32>> = serde_json::from_value(value["faces"].clone())?;
    let point = |[x, y, z]: [String; 3]| -> Result<_, Failure> {
        Ok(Vec3::new(Number::parse(&x)?, Number::parse(&y)?, Number::parse(&z)?))
    };
    let vertices = vertices.into_iter().map(point).collect::<Result<Vec<_>, _>>()?;
    Ok(Block::new(vertices, faces, &BlockOptions::default())?)
}

fn shape(prepared: &PreparedBlock<f64>) -> Option<ConvexPolyhedron> {
    let points: Vec<ParryVector> = prepared.vertices().iter().map(|v| ParryVector::from(v.at.components())).collect();
    let fan =
        |face: &Vec<VertexId>| face[1..].windows(2).map(|two| [face[0].0, two[0].0, two[1].0]).collect::<Vec<_>>();
    let triangles: Vec<[u32; 3]> = prepared.block().topology().faces().iter().flat_map(fan).collect();
    ConvexPolyhedron::from_convex_mesh(points.clone(), &triangles)
        .or_else(|| ConvexPolyhedron::from_convex_hull(&points))
}

impl TimedPair {
    /// The pair of one line; `None` where a block is concave or rounding makes it degenerate, where features are not looked for by lists, or where one of
    /// the codes sees other contacts at the second place.
    pub fn read(line: &str) -> Result<Option<TimedPair>, Failure> {
        let value: Value = serde_json::from_str(line)?;
        let set: ToleranceSet = serde_json::from_value(value["tolerances"].clone())?;
        let (a, b) = (block(&value["a"])?, block(&value["b"])?);
        Ok(if value["separation"].is_null() { None } else { TimedPair::of(&a, &b, &set) })
    }

    fn of(a: &Block, b: &Block, set: &ToleranceSet) -> Option<TimedPair> {
        let tolerances = Tolerances::<f64>::new(set).ok()?;
        let (a, here) = (PreparedBlock::new(a).ok()?, PreparedBlock::new(b).ok()?);
        let step = skin(tolerances.search) * SHARE_OF_SKIN;
        let at: Vec<Vector<f64>> = here.vertices().iter().map(|vertex| vertex.at).collect();
        let moved = at.iter().map(|&point| point + Vector::new(step, step, step)).collect::<Vec<_>>();
        let there = here.clone().with_points(&moved).ok()?;
        let request = ClassificationRequest { a: &a, b: &here, tolerances: &tolerances, kept: &[], among: None };
        let nearby = NearbyFeatures::of(request, skin(tolerances.search))?;
        let shapes = [shape(&a)?, shape(&here)?];
        let poses = [Pose::identity(), Pose::from_translation(ParryVector::new(step, step, step))];
        let again = Some(here.clone());
        let (b, points) = ([here, there], [at, moved]);
        let mut pair =
            TimedPair { tolerances, a, b, points, again, nearby, shapes, poses, manifold: ContactManifold::new() };
        let same = pair.contacts(0) == pair.contacts(1) && pair.cold_manifold(0) == pair.cold_manifold(1);
        same.then_some(pair)
    }

    /// Whether both codes see contacts, at the first place.
    pub fn has_contacts(&self) -> bool {
        !self.contacts(0).is_empty() && self.manifold_at(0, &mut ContactManifold::new()) > 0
    }

    fn contacts(&self, place: usize) -> Vec<ContactKey> {
        let b = &self.b[place];
        let request = ClassificationRequest { a: &self.a, b, tolerances: &self.tolerances, kept: &[], among: None };
        SpecRules::contacts(request).iter().map(|computed| computed.contact.key).collect()
    }

    fn manifold_at(&self, place: usize, manifold: &mut ContactManifold<(), ()>) -> usize {
        let [a, b] = &self.shapes;
        let prediction = self.tolerances.search;
        let found = DefaultQueryDispatcher.contact_manifold_convex_convex(
            &self.poses[place],
            a,
            b,
            None,
            None,
            prediction,
            manifold,
        );
        found.map_or(0, |()| manifold.points.len())
    }

    /// parry with an empty manifold.
    pub fn cold_manifold(&mut self, place: usize) -> usize {
        self.manifold_at(place, &mut ContactManifold::new())
    }

    /// parry with the manifold of the time before.
    pub fn warm_manifold(&mut self, place: usize) -> usize {
        let mut manifold = std::mem::take(&mut self.manifold);
        let points = self.manifold_at(place, &mut manifold);
        self.manifold = manifold;
        points
    }

    fn stepper(&self, b: &PreparedBlock<f64>, among: Option<&NearbyFeatures>) -> usize {
        let request = ClassificationRequest { a: &self.a, b, tolerances: &self.tolerances, kept: &[], among };
        std::hint::black_box(SpecRules::contacts(request)).len()
    }

    /// The stepper, which looks at all features.
    pub fn all_features(&mut self, place: usize) -> usize {
        self.stepper(&self.b[place], None)
    }

    /// The stepper, which looks at the features that can touch.
    pub fn known_features(&mut self, place: usize) -> usize {
        self.stepper(&self.b[place], Some(&self.nearby))
    }

    /// The same, and B is prepared where it is now.
    pub fn prepared_again(&mut self, place: usize) -> usize {
        let Some(b) = self.again.take().and_then(|b| b.with_points(&self.points[place]).ok()) else { return 0 };
        let contacts = self.stepper(&b, Some(&self.nearby));
        self.again = Some(b);
        contacts
    }
}
