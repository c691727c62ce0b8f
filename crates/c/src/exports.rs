//! Every function of the library, as C sees it.
#![allow(unsafe_code, reason = "names are exported, and arrays, texts and places for answers come as pointers")]
// The names begin with rockproof_, so that no other library has them: that is what `#[unsafe(no_mangle)]` asks of each function here.

use crate::block::{Block, Edge, Model, Point};
use crate::boundary::{guarded, last_error, slice, str_of};
use crate::check::Check;
use crate::contacts::{Contact, Contacts};
use crate::distance::Distance;
use crate::tolerances::Tolerances;
use num_traits::ToPrimitive;
use rockproof_model::Precision;
use std::ffi::{CStr, CString, c_char};
use std::mem::MaybeUninit;

/// The oracle: every decision proved.
pub const ROCKPROOF_EXACT: i32 = 0;
/// The float code in double.
pub const ROCKPROOF_F64: i32 = 1;
/// The float code in float.
pub const ROCKPROOF_F32: i32 = 2;

const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
    Ok(version) => version,
    Err(_) => c"",
};

/// The precision of an engine; none is exact.
fn engine(number: i32) -> Result<Option<Precision>, String> {
    match number {
        ROCKPROOF_EXACT => Ok(None),
        ROCKPROOF_F64 => Ok(Some(Precision::F64)),
        ROCKPROOF_F32 => Ok(Some(Precision::F32)),
        other => {
            Err(format!("engine is {other}; allowed are ROCKPROOF_EXACT (0), ROCKPROOF_F64 (1) and ROCKPROOF_F32 (2)"))
        }
    }
}

fn pair<'a>(a: Option<&'a Block>, b: Option<&'a Block>) -> Result<[&'a Block; 2], String> {
    let missing = |name: &str| format!("block {name} is null");
    Ok([a.ok_or_else(|| missing("a"))?, b.ok_or_else(|| missing("b"))?])
}

/// Writes an answer where C wants it, if there is both.
fn write<T>(place: Option<&mut MaybeUninit<T>>, answer: Option<T>) -> bool {
    match (place, answer) {
        (Some(place), Some(answer)) => {
            place.write(answer);
            true
        }
        _ => false,
    }
}

fn pointer(text: Option<&CString>) -> *const c_char {
    text.map_or(std::ptr::null(), |text| text.as_ptr())
}

/// The version of the library, as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_version() -> *const c_char {
    VERSION.as_ptr()
}

/// Why the last call on this thread that can fail answered null or false; null if it did not. The text names what was wrong, what was found
/// and what is allowed; of a file also the line, of a block the vertex or face. It is gone with the next such call on the same thread.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_last_error() -> *const c_char {
    last_error()
}

/// A block from arrays: `vertex_count` times x, y, z in metres, each exactly the number that the double is; `face_count` faces of
/// `face_lengths` vertices each, whose numbers, from 0 and counter-clockwise seen from outside, follow one another in `face_vertices`. A face
/// may be `planarity` of the block's size from planar; a negative number means 1e-9. Coplanar neighbours are merged. Null if they are no
/// block. Free it with `rockproof_block_free`.
///
/// # Safety
/// The arrays have as many elements as said (`face_vertices` the sum of `face_lengths`), and nobody changes them during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rockproof_block_new(
    vertices: *const f64,
    vertex_count: usize,
    face_vertices: *const u32,
    face_lengths: *const u32,
    face_count: usize,
    planarity: f64,
) -> Option<Box<Block>> {
    guarded(|| {
        let coordinates = vertex_count.checked_mul(3).ok_or("vertex_count is more than a memory holds")?;
        // SAFETY: the caller answers for the array and its length, three numbers a vertex.
        let vertices = unsafe { slice(vertices, coordinates, "vertices") }?;
        // SAFETY: the caller answers for the array and its length.
        let lengths = unsafe { slice(face_lengths, face_count, "face_lengths") }?;
        let total = lengths.iter().try_fold(0usize, |total, &length| total.checked_add(length as usize));
        let total = total.ok_or("face_lengths add up to more than a memory holds")?;
        // SAFETY: the caller answers for the array, which has as many elements as the lengths add up to.
        let corners = unsafe { slice(face_vertices, total, "face_vertices") }?;
        Block::from_arrays(vertices, corners, lengths, planarity).map(Box::new)
    })
}

/// Frees a block; null is left alone. Nothing made of it is touched.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_block_free(block: Option<Box<Block>>) {
    drop(block);
}

/// The number of vertices; 0 of null.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_block_vertex_count(block: Option<&Block>) -> usize {
    block.map_or(0, |block| block.vertices.len())
}

/// The number of edges; 0 of null.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_block_edge_count(block: Option<&Block>) -> usize {
    block.map_or(0, |block| block.block.topology().edges().len())
}

/// The number of faces; 0 of null.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_block_face_count(block: Option<&Block>) -> usize {
    block.map_or(0, |block| block.block.topology().faces().len())
}

/// A vertex, to the nearest double. False where there is no such vertex, and `out` is left alone.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_block_vertex(
    block: Option<&Block>,
    vertex: usize,
    out: Option<&mut MaybeUninit<Point>>,
) -> bool {
    write(out, block.and_then(|block| block.vertices.get(vertex)).copied())
}

/// The two vertices of an edge. False where there is no such edge, and `out` is left alone.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_block_edge(
    block: Option<&Block>,
    edge: usize,
    out: Option<&mut MaybeUninit<Edge>>,
) -> bool {
    let edge = block.and_then(|block| block.block.topology().edges().get(edge));
    write(out, edge.map(|edge| Edge { p: edge.p.0, q: edge.q.0 }))
}

/// The vertices of a face, counter-clockwise seen from outside, and their number in `length`; they are the block's, and gone with it. Null
/// where there is no such face.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_block_face(
    block: Option<&Block>,
    face: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> *const u32 {
    let face = block.and_then(|block| block.block.topology().faces().get(face));
    match face {
        Some(face) if write(length, Some(face.len())) => face.as_ptr().cast(),
        _ => std::ptr::null(),
    }
}

/// Whether all edges are convex; false of null.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_block_is_convex(block: Option<&Block>) -> bool {
    block.is_some_and(|block| block.block.is_convex())
}

/// The volume in m³, to the nearest double; 0 of null.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_block_volume(block: Option<&Block>) -> f64 {
    guarded(|| Ok(block.and_then(|block| block.block.volume().to_f64()).unwrap_or(0.0))).unwrap_or(0.0)
}

/// The blocks of a file of any format that Rockproof reads. `planarity` as for `rockproof_block_new`, a negative number meaning what the file
/// says; vertices no further apart than `weld` are joined, a negative number meaning none but those of STL that are one point. Null if the
/// file or a block in it cannot be used. Free it with `rockproof_model_free`.
///
/// # Safety
/// `path` ends with a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rockproof_model_load(path: *const c_char, planarity: f64, weld: f64) -> Option<Box<Model>> {
    guarded(|| {
        // SAFETY: the caller answers for the text and its end.
        let path = unsafe { str_of(path, "path") }?;
        Model::load(path, planarity, weld, None).map(Box::new)
    })
}

/// As `rockproof_model_load`, with every length multiplied by `scale` after vertices are joined, exactly: "1/1000" for a file in
/// millimetres. Null, too, if that is no number above 0, or not 1 for a scene in TOML, which is in metres.
///
/// # Safety
/// `path` and `scale` end with a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rockproof_model_load_scaled(
    path: *const c_char,
    planarity: f64,
    weld: f64,
    scale: *const c_char,
) -> Option<Box<Model>> {
    guarded(|| {
        // SAFETY: the caller answers for both texts and their ends.
        let (path, scale) = unsafe { (str_of(path, "path")?, str_of(scale, "scale")?) };
        Model::load(path, planarity, weld, Some(scale)).map(Box::new)
    })
}

/// Frees a model; null is left alone. Blocks taken out of it stay.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_model_free(model: Option<Box<Model>>) {
    drop(model);
}

/// The number of blocks; 0 of null.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_model_block_count(model: Option<&Model>) -> usize {
    model.map_or(0, Model::count)
}

/// A block of a model, from 0. It is the caller's: free it with `rockproof_block_free`, before or after the model. Null where there is none.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_model_block(model: Option<&Model>, number: usize) -> Option<Box<Block>> {
    guarded(|| {
        let block = model.ok_or("model is null")?.block(number)?;
        Ok(Box::new(Block::new(block.block.clone())))
    })
}

/// Tolerances of a preset: "auto", "shi" or "zero". Null if it is none of them. Free them with `rockproof_tolerances_free`.
///
/// # Safety
/// `preset` ends with a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rockproof_tolerances_new(preset: *const c_char) -> Option<Box<Tolerances>> {
    guarded(|| {
        // SAFETY: the caller answers for the text and its end.
        let preset = unsafe { str_of(preset, "preset") }?;
        Tolerances::of_preset(preset).map(Box::new)
    })
}

/// Sets one value in place of the preset's, exactly: "search=1/10", "overlap_angle=3", "criteria=classic". False if it cannot be, and
/// nothing has changed. No other thread may use the tolerances meanwhile.
///
/// # Safety
/// `assignment` ends with a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rockproof_tolerances_set(
    tolerances: Option<&mut Tolerances>,
    assignment: *const c_char,
) -> bool {
    guarded(|| {
        // SAFETY: the caller answers for the text and its end.
        let assignment = unsafe { str_of(assignment, "assignment") }?;
        tolerances.ok_or("tolerances are null")?.set(assignment)
    })
    .is_some()
}

/// Frees tolerances; null is left alone.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_tolerances_free(tolerances: Option<Box<Tolerances>>) {
    drop(tolerances);
}

/// The contacts of two blocks, found by `ROCKPROOF_EXACT`, `ROCKPROOF_F64` or `ROCKPROOF_F32`; the last two round blocks and tolerances to
/// their precision first. Null tolerances are those of "auto". Null if a block does not survive rounding, or tolerances cannot be. Free them
/// with `rockproof_contacts_free`.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_classify(
    a: Option<&Block>,
    b: Option<&Block>,
    tolerances: Option<&Tolerances>,
    engine: i32,
) -> Option<Box<Contacts>> {
    guarded(|| Contacts::of(pair(a, b)?, tolerances, self::engine(engine)?).map(Box::new))
}

/// Frees contacts; null is left alone.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_contacts_free(contacts: Option<Box<Contacts>>) {
    drop(contacts);
}

/// The number of contacts; 0 of null.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_contacts_count(contacts: Option<&Contacts>) -> usize {
    contacts.map_or(0, |contacts| contacts.0.len())
}

/// One of the contacts, from 0. False where there is none, and `out` is left alone.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_contacts_get(
    contacts: Option<&Contacts>,
    number: usize,
    out: Option<&mut MaybeUninit<Contact>>,
) -> bool {
    write(out, contacts.and_then(|contacts| contacts.0.get(number)).map(|(contact, _)| *contact))
}

/// The gap of a contact in metres as a fraction, "-1/3", which is exact; null where it is irrational, or there is no such contact. Of a float
/// engine, the number that it calculated. The text is the contacts', and gone with them.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_contacts_gap_exact(contacts: Option<&Contacts>, number: usize) -> *const c_char {
    pointer(contacts.and_then(|contacts| contacts.0.get(number)).and_then(|(_, gap)| gap.exact.as_ref()))
}

/// The square of the gap of a contact in m² as a fraction, which is exact whatever the gap is; null where there is no such contact.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_contacts_gap_squared(contacts: Option<&Contacts>, number: usize) -> *const c_char {
    pointer(contacts.and_then(|contacts| contacts.0.get(number)).map(|(_, gap)| &gap.squared))
}

/// How two convex blocks lie to one another, exactly: the distance, or minus the length of the shortest translation that parts them. Null
/// where a block is concave or has more than 48 vertices. Free it with `rockproof_distance_free`.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_separation(a: Option<&Block>, b: Option<&Block>) -> Option<Box<Distance>> {
    guarded(|| pair(a, b).and_then(|[a, b]| Distance::separation(a, b)).map(Box::new))
}

/// How deep two blocks overlap, exactly: minus the depth, or 0. Of two convex blocks the shortest translation that parts them; of others
/// the distance from the other's surface of the deepest vertex, or of the deepest middle of an edge within the other. Free it with
/// `rockproof_distance_free`.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_penetration(a: Option<&Block>, b: Option<&Block>) -> Option<Box<Distance>> {
    guarded(|| pair(a, b).and_then(|[a, b]| Distance::penetration(a, b)).map(Box::new))
}

/// Frees a distance; null is left alone.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_distance_free(distance: Option<Box<Distance>>) {
    drop(distance);
}

/// 1 apart, 0 touching (or, of a penetration, not overlapping), -1 overlapping; 0 of null.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_distance_sign(distance: Option<&Distance>) -> i32 {
    distance.map_or(0, |distance| distance.sign)
}

/// The distance in metres to the nearest double, negative for an overlap; 0 of null.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_distance_nearest(distance: Option<&Distance>) -> f64 {
    distance.map_or(0.0, |distance| distance.nearest)
}

/// The distance in metres as a fraction, which is exact; null where it is irrational. The text is gone with the distance.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_distance_exact(distance: Option<&Distance>) -> *const c_char {
    pointer(distance.and_then(|distance| distance.exact.as_ref()))
}

/// The square of the distance in m² as a fraction, which is exact whatever the distance is. The text is gone with the distance.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_distance_squared(distance: Option<&Distance>) -> *const c_char {
    pointer(distance.map(|distance| &distance.squared))
}

/// The rules that tolerances break for two blocks in double (`ROCKPROOF_F64`) or float (`ROCKPROOF_F32`). Null tolerances are those of
/// "auto". Free the answer with `rockproof_check_free`.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_check(
    a: Option<&Block>,
    b: Option<&Block>,
    tolerances: Option<&Tolerances>,
    engine: i32,
) -> Option<Box<Check>> {
    guarded(|| {
        let precision =
            self::engine(engine)?.ok_or("rules are about floats; allowed are ROCKPROOF_F64 and ROCKPROOF_F32")?;
        Check::of(pair(a, b)?, tolerances, precision).map(Box::new)
    })
}

/// Frees a check; null is left alone.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_check_free(check: Option<Box<Check>>) {
    drop(check);
}

/// The number of rules broken; 0 of null.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_check_count(check: Option<&Check>) -> usize {
    check.map_or(0, |check| check.0.len())
}

/// A rule broken, from 0: what was found, what is allowed, what would satisfy it, and why there is the rule. Null where there is none. The
/// text is gone with the check.
#[unsafe(no_mangle)]
pub extern "C" fn rockproof_check_text(check: Option<&Check>, number: usize) -> *const c_char {
    pointer(check.and_then(|check| check.0.get(number)))
}
