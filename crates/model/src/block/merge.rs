//! The canonical form: coplanar neighbours become one face, vertices in line between two edges go (SPEC section 2).

use crate::block::build::BlockDraft;
use crate::block::certain_sign::{Coordinates, Surface};
use crate::block::error::BlockError;
use crate::block::planarity::Planarity;
use crate::block::polynomials::{Area, BeyondAlongLine, OffLine, SameSide, SquaredLength};
use crate::block::simple::check_simple;
use crate::block::{Block, BlockOptions, Merging};
use crate::sign::Sign;
use crate::topology::{EdgeId, FaceId, Topology, VertexId};
use std::cmp::Reverse;

/// Merges what `merging` says. `signs` are those of κ at the draft's edges.
pub(super) fn merge(
    draft: BlockDraft,
    signs: &[Sign],
    options: &BlockOptions,
    merging: Merging,
) -> Result<BlockDraft, BlockError> {
    let (faces, vertices) = (draft.topology.faces().len(), draft.vertices.len());
    let nothing_left = |(error, left): (crate::TopologyError, (usize, usize))| BlockError::NothingLeft {
        faces: faces - left.0,
        vertices: vertices - left.1,
        error,
    };
    let groups = flat_groups(&draft.topology, signs);
    let mut draft = match merged_faces(&draft, &groups)? {
        Some(faces) => rebuilt(draft, faces).map_err(nothing_left)?,
        None => draft,
    };
    if merging == Merging::WithinPlanarity {
        let groups = near_flat_groups(&draft, options);
        if let Some(faces) = merged_faces(&draft, &groups)? {
            draft = rebuilt(draft, faces).map_err(nothing_left)?;
        }
    }
    match without_vertices_in_line(&draft, options, merging) {
        Some(faces) => rebuilt(draft, faces).map_err(nothing_left),
        None => Ok(draft),
    }
}

/// Loops with the number of the face each continues.
type Loops = Vec<(usize, Vec<VertexId>)>;

/// The draft with other faces over the same vertices; vertices that no face uses any more go.
fn rebuilt(draft: BlockDraft, faces: Loops) -> Result<BlockDraft, (crate::TopologyError, (usize, usize))> {
    let mut used = vec![false; draft.vertices.len()];
    for &v in faces.iter().flat_map(|(_, boundary)| boundary) {
        used[v.index()] = true;
    }
    let mut next = 0;
    let place: Vec<VertexId> = used
        .iter()
        .map(|&used| {
            next += u32::from(used);
            VertexId(next.saturating_sub(1))
        })
        .collect();
    let face_names = faces.iter().map(|&(face, _)| draft.face_names[face]).collect();
    let loops: Vec<Vec<VertexId>> =
        faces.into_iter().map(|(_, boundary)| boundary.iter().map(|&v| place[v.index()]).collect()).collect();
    let left = (loops.len(), next as usize);
    Ok(BlockDraft {
        topology: Topology::new(next as usize, loops).map_err(|error| (error, left))?,
        vertices: kept(draft.vertices, &used),
        approximate: kept(draft.approximate, &used),
        vertex_names: kept(draft.vertex_names, &used),
        face_names,
    })
}

fn kept<T>(all: Vec<T>, used: &[bool]) -> Vec<T> {
    all.into_iter().zip(used).filter(|(_, used)| **used).map(|(item, _)| item).collect()
}

/// For every face the lowest number in its group of faces joined by flat edges.
fn flat_groups(topology: &Topology, signs: &[Sign]) -> Vec<usize> {
    let count = topology.faces().len();
    let mut group: Vec<usize> = vec![usize::MAX; count];
    for first in 0..count {
        if group[first] != usize::MAX {
            continue;
        }
        group[first] = first;
        let mut queue = vec![first];
        while let Some(face) = queue.pop() {
            for &edge in topology.face_edges(FaceId::at(face)) {
                let ends = topology.edge(edge);
                for next in [ends.left.index(), ends.right.index()] {
                    if signs[edge.index()].is_zero() && group[next] == usize::MAX {
                        group[next] = first;
                        queue.push(next);
                    }
                }
            }
        }
    }
    group
}

/// The loops after merging every group, or `None` when no group has two faces.
fn merged_faces(draft: &BlockDraft, group: &[usize]) -> Result<Option<Loops>, BlockError> {
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); group.len()];
    for (face, &first) in group.iter().enumerate() {
        members[first].push(face);
    }
    if members.iter().all(|m| m.len() < 2) {
        return Ok(None);
    }
    let mut loops = Loops::new();
    for (first, members) in members.iter().enumerate().filter(|(_, m)| !m.is_empty()) {
        let boundary = if let [only] = members.as_slice() {
            draft.topology.faces()[*only].clone()
        } else {
            let (face, count) = (draft.face_names[first], members.len());
            outline(&draft.topology, members, group).map_err(|problem| match problem {
                OutlineProblem::Hole => BlockError::FaceWithHole { face, count },
                OutlineProblem::Pinch(v) => {
                    BlockError::PinchedFace { face, count, vertex: draft.vertex_names[v.index()] }
                }
            })?
        };
        loops.push((first, boundary));
    }
    Ok(Some(loops))
}

enum OutlineProblem {
    Hole,
    Pinch(VertexId),
}

/// The one loop around the faces `members`, all of which have the same entry in `group`.
fn outline(topology: &Topology, members: &[usize], group: &[usize]) -> Result<Vec<VertexId>, OutlineProblem> {
    let inside = |face: FaceId| group[face.index()] == group[members[0]];
    let is_inner = |edge: EdgeId| {
        let edge = topology.edge(edge);
        inside(edge.left) && inside(edge.right)
    };
    let sides = |face: usize| {
        let edges = topology.face_edges(FaceId::at(face));
        edges.iter().enumerate().filter(|(_, edge)| !is_inner(**edge)).map(move |(place, _)| (face, place))
    };
    let outer: Vec<(usize, usize)> = members.iter().flat_map(|&face| sides(face)).collect();
    let &start = outer.first().ok_or(OutlineProblem::Hole)?;
    let mut boundary = Vec::new();
    let (mut face, mut place) = start;
    loop {
        boundary.push(topology.faces()[face][place]);
        // On to the next side; where that is inside, turn round its end until one is not.
        place = (place + 1) % topology.faces()[face].len();
        let mut edge = topology.face_edges(FaceId::at(face))[place];
        while is_inner(edge) {
            let ends = topology.edge(edge);
            face = if ends.left.index() == face { ends.right } else { ends.left }.index();
            let edges = topology.face_edges(FaceId::at(face));
            place = (edges.iter().position(|&e| e == edge).unwrap_or(0) + 1) % edges.len();
            edge = edges[place];
        }
        if (face, place) == start || boundary.len() > outer.len() {
            break;
        }
    }
    if boundary.len() != outer.len() {
        return Err(OutlineProblem::Hole);
    }
    let mut sorted = boundary.clone();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(OutlineProblem::Pinch(pair[0])),
        None => Ok(boundary),
    }
}

/// Groups of faces that one plane holds within the planarity allowed. Regions grow from the largest face, whose plane
/// is the best known; one that turns out further from planar by its own plane grows again within half the distance.
fn near_flat_groups(draft: &BlockDraft, options: &BlockOptions) -> Vec<usize> {
    let coordinates = Coordinates::new(&draft.vertices, &draft.approximate);
    let surface = Surface::new(&coordinates, draft.topology.faces());
    let planarity = Planarity::new(&coordinates, options);
    if !any_near_neighbour(&surface, &draft.topology, &planarity) {
        return (0..surface.faces().len()).collect();
    }
    let mut seeds: Vec<usize> = (0..surface.faces().len()).collect();
    seeds.sort_by_cached_key(|&face| Reverse(surface.exact_value(&Area { face })));
    let mut group: Vec<Option<usize>> = vec![None; seeds.len()];
    for seed in seeds {
        if group[seed].is_some() {
            continue;
        }
        group[seed] = Some(seed);
        for parts in [1, 2, 4, 8] {
            let region = grow(&surface, &draft.topology, &planarity, (seed, parts), &group);
            if region.len() == 1 {
                break;
            }
            if is_one_face(&coordinates, draft, &planarity, &region) {
                let first = region.iter().copied().min().unwrap_or(seed);
                for face in region {
                    group[face] = Some(first);
                }
                break;
            }
        }
    }
    group.iter().enumerate().map(|(face, first)| first.unwrap_or(face)).collect()
}

/// Whether f64 leaves it open that some face is within the planarity of the plane of a neighbour: with no such face no region grows.
fn any_near_neighbour(surface: &Surface<'_>, topology: &Topology, planarity: &Planarity<'_>) -> bool {
    let faces = surface.faces();
    let is_far =
        |seed: usize, other: usize| planarity.surely_misses_one(surface, (seed, faces[seed][0]), &faces[other], 1);
    topology.edges().iter().any(|edge| {
        let [left, right] = [edge.left.index(), edge.right.index()];
        !is_far(left, right) || !is_far(right, left)
    })
}

/// As [`any_near_neighbour`], of a block.
pub(super) fn may_merge_within(block: &Block, options: &BlockOptions) -> bool {
    let approximate: Vec<[f64; 3]> = block.vertices().iter().map(|v| v.components().map(|c| c.approximate())).collect();
    let coordinates = Coordinates::new(block.vertices(), &approximate);
    let surface = Surface::new(&coordinates, block.topology().faces());
    any_near_neighbour(&surface, block.topology(), &Planarity::new(&coordinates, options))
}

fn grow(
    surface: &Surface<'_>,
    topology: &Topology,
    planarity: &Planarity<'_>,
    (seed, parts): (usize, u32),
    taken: &[Option<usize>],
) -> Vec<usize> {
    let plane = (seed, surface.faces()[seed][0]);
    let mut seen = vec![false; taken.len()];
    seen[seed] = true;
    let mut region = vec![seed];
    let mut next = 0;
    while let Some(&face) = region.get(next) {
        next += 1;
        for &edge in topology.face_edges(FaceId::at(face)) {
            let ends = topology.edge(edge);
            for other in [ends.left.index(), ends.right.index()] {
                if std::mem::replace(&mut seen[other], true) || taken[other].is_some() {
                    continue;
                }
                let same_side = SameSide { left: FaceId::at(seed), right: FaceId::at(other) };
                if surface.sign(&same_side).is_positive()
                    && planarity.holds_all(surface, plane, &surface.faces()[other], parts)
                {
                    region.push(other);
                }
            }
        }
    }
    region
}

/// Whether the faces of a region make one simple face that is planar by its own plane.
fn is_one_face(coordinates: &Coordinates<'_>, draft: &BlockDraft, planarity: &Planarity<'_>, region: &[usize]) -> bool {
    let mut inside = vec![usize::MAX; draft.topology.faces().len()];
    for &face in region {
        inside[face] = 0;
    }
    let Ok(boundary) = outline(&draft.topology, region, &inside) else { return false };
    let faces = [boundary];
    let surface = Surface::new(coordinates, &faces);
    surface.sign(&Area { face: 0 }).is_positive()
        && planarity.violation(&surface, 0).is_none()
        && check_simple(&surface, 0, &draft.approximate, planarity.slack()).is_ok()
}

/// The loops without the vertices that have two edges in line, or `None` when there are none.
fn without_vertices_in_line(draft: &BlockDraft, options: &BlockOptions, merging: Merging) -> Option<Loops> {
    let topology = &draft.topology;
    let coordinates = Coordinates::new(&draft.vertices, &draft.approximate);
    let surface = Surface::new(&coordinates, topology.faces());
    let planarity = Planarity::new(&coordinates, options);
    let in_line = |v: VertexId| {
        let [first, second] = topology.vertex_edges(v) else { return false };
        let [a, b] = [first, second].map(|&e| topology.edge(e).other(v));
        let on_line = || {
            surface.sign(&OffLine { a, v, b }).is_zero()
                || merging == Merging::WithinPlanarity
                    && planarity.allows(
                        &surface.exact_value(&OffLine { a, v, b }),
                        &surface.exact_value(&SquaredLength { a, b }),
                    )
        };
        surface.sign(&BeyondAlongLine { a, v, b }).is_positive() && on_line()
    };
    let drop: Vec<bool> = topology.vertex_ids().map(in_line).collect();
    drop.contains(&true).then(|| {
        let shortened = |boundary: &Vec<VertexId>| boundary.iter().copied().filter(|&v| !drop[v.index()]).collect();
        topology.faces().iter().map(shortened).enumerate().collect()
    })
}
