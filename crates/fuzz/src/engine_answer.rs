//! What external engines answer: every line is an answer about the features that there are, or malformed.

use crate::reach::Reach;
use rockproof_differential::engine::{Answer, EngineFailure};
use rockproof_differential::external::protocol;
use rockproof_model::{Block, Contact, ContactKind, EntranceKind, Number, Point};
use std::sync::OnceLock;

/// The question that is answered.
const QUESTION: u64 = 7;

fn cube() -> &'static Block {
    static CUBE: OnceLock<Block> = OnceLock::new();
    let corner = |n: i32| Point::new(Number::from_integer(n), Number::from_integer(n), Number::from_integer(n));
    CUBE.get_or_init(|| Block::cuboid(&corner(0), &corner(1)).expect("a cube"))
}

/// A line in answer to a question about two cubes.
///
/// # Panics
/// When an answer names what the cubes do not have, or a message is too long.
pub(crate) fn engine_answer(bytes: &[u8], reach: &mut Reach) {
    let topology = cube().topology();
    match protocol::answer(bytes, QUESTION, [topology, topology]) {
        Ok(Answer::Contacts(contacts)) => {
            assert!(contacts.iter().all(exists), "features that are not there: {contacts:?}");
            assert!(contacts.is_sorted(), "contacts in order: {contacts:?}");
            reach.count("contacts");
        }
        Ok(Answer::State(said)) => reach.count(format!("state-{}", said.state)),
        Err(failure @ (EngineFailure::Malformed(_) | EngineFailure::Unsupported(_))) => {
            let message = failure.to_string();
            assert!(message.len() < 2_000, "a message of {} bytes: {message}", message.len());
            reach.count(Reach::variant(&failure));
        }
        Err(other) => panic!("a line in answer cannot be {other}"),
    }
}

/// Whether both cubes have what a contact names; what is not named is nothing they must have.
fn exists(contact: &Contact) -> bool {
    let (vertices, edges, faces) = (8, 12, 6);
    let [a, b] = match contact.kind() {
        ContactKind::VertexVertex => [vertices, vertices],
        ContactKind::VertexEdge => [vertices, edges],
        ContactKind::EdgeVertex => [edges, vertices],
        ContactKind::VertexFace => [vertices, faces],
        ContactKind::FaceVertex => [faces, vertices],
        ContactKind::EdgeEdge => [edges, edges],
    };
    let [entrance_a, entrance_b] = match contact.entrance.kind() {
        EntranceKind::VertexFace => [vertices, faces],
        EntranceKind::FaceVertex => [faces, vertices],
        EntranceKind::EdgeEdge => [edges, edges],
    };
    let ([of_a, of_b], of_entrance) = (contact.key.numbers(), contact.entrance.numbers());
    let named = of_entrance != [u32::MAX, u32::MAX];
    of_a < a && of_b < b && (!named || of_entrance[0] < entrance_a && of_entrance[1] < entrance_b)
}
