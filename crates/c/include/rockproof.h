/* Rockproof for C and C++: docs/c.md. Made from crates/c/src/exports.rs; do not edit.
 *
 * Handles may be null wherever they are taken. Each is freed once, by its own function. No call throws or longjmps.
 * Handles never change after they were made, tolerances apart, so threads may share them; errors are kept by thread. */

#ifndef ROCKPROOF_H
#define ROCKPROOF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// The oracle: every decision proved.
#define ROCKPROOF_EXACT 0

// The float code in double.
#define ROCKPROOF_F64 1

// The float code in float.
#define ROCKPROOF_F32 2

// Which features touch; A's is named first.
typedef enum RockproofContactKind {
  // A vertex and a vertex.
  ROCKPROOF_CONTACT_KIND_VERTEX_VERTEX,
  // A vertex of A and an edge of B.
  ROCKPROOF_CONTACT_KIND_VERTEX_EDGE,
  // An edge of A and a vertex of B.
  ROCKPROOF_CONTACT_KIND_EDGE_VERTEX,
  // A vertex of A and a face of B.
  ROCKPROOF_CONTACT_KIND_VERTEX_FACE,
  // A face of A and a vertex of B.
  ROCKPROOF_CONTACT_KIND_FACE_VERTEX,
  // Two edges that cross.
  ROCKPROOF_CONTACT_KIND_EDGE_EDGE,
} RockproofContactKind;

// Which features span the plane through which the blocks enter one another; A's is named first.
typedef enum RockproofEntranceKind {
  // A vertex of A and a face of B.
  ROCKPROOF_ENTRANCE_KIND_VERTEX_FACE,
  // A face of A and a vertex of B.
  ROCKPROOF_ENTRANCE_KIND_FACE_VERTEX,
  // An edge of each.
  ROCKPROOF_ENTRANCE_KIND_EDGE_EDGE,
} RockproofEntranceKind;

// A closed polyhedron with exact vertices in metres. It never changes, so threads may share it.
typedef struct RockproofBlock RockproofBlock;

// The rules that tolerances break for two blocks. It never changes, so threads may share it.
typedef struct RockproofCheck RockproofCheck;

// The contacts of two blocks, sorted by kind and features. They never change, so threads may share them.
typedef struct RockproofContacts RockproofContacts;

// A length with a sign that is known exactly: positive apart, negative for an overlap. It never changes, so threads may share it.
typedef struct RockproofDistance RockproofDistance;

// The blocks of a file. It never changes, so threads may share it.
typedef struct RockproofModel RockproofModel;

// Tolerances. Setting a value is the only change; threads may share them while nobody does.
typedef struct RockproofTolerances RockproofTolerances;

// Coordinates in metres.
typedef struct RockproofPoint {
  // Along x.
  double x;
  // Along y.
  double y;
  // Along z.
  double z;
} RockproofPoint;

// An edge by its two vertices.
typedef struct RockproofEdge {
  // The vertex with the lower number.
  uint32_t p;
  // The vertex with the higher number.
  uint32_t q;
} RockproofEdge;

// A contact. Features are numbered as `rockproof_block_vertex`, `rockproof_block_edge` and `rockproof_block_face` number them.
typedef struct RockproofContact {
  // Which features touch.
  enum RockproofContactKind kind;
  // A's vertex, edge or face, by `kind`.
  uint32_t feature_a;
  // B's, likewise.
  uint32_t feature_b;
  // Which features span the entrance plane.
  enum RockproofEntranceKind entrance;
  // A's feature of the entrance plane.
  uint32_t entrance_a;
  // B's, likewise.
  uint32_t entrance_b;
  // 1 apart, 0 touching, -1 overlapping.
  int32_t gap_sign;
  // The gap in metres, negative for an overlap: the double nearest to the exact one, or what floats calculate.
  double gap;
} RockproofContact;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the library, as "0.1.0".
const char *rockproof_version(void);

// Why the last call on this thread that can fail answered null or false; null if it did not. The text names what was wrong, what was found
// and what is allowed; of a file also the line, of a block the vertex or face. It is gone with the next such call on the same thread.
const char *rockproof_last_error(void);

// A block from arrays: `vertex_count` times x, y, z in metres, each exactly the number that the double is; `face_count` faces of
// `face_lengths` vertices each, whose numbers, from 0 and counter-clockwise seen from outside, follow one another in `face_vertices`. A face
// may be `planarity` of the block's size from planar; a negative number means 1e-9. Coplanar neighbours are merged. Null if they are no
// block. Free it with `rockproof_block_free`.
//
// # Safety
// The arrays have as many elements as said (`face_vertices` the sum of `face_lengths`), and nobody changes them during the call.
struct RockproofBlock *rockproof_block_new(const double *vertices,
                                           size_t vertex_count,
                                           const uint32_t *face_vertices,
                                           const uint32_t *face_lengths,
                                           size_t face_count,
                                           double planarity);

// Frees a block; null is left alone. Nothing made of it is touched.
void rockproof_block_free(struct RockproofBlock *block);

// The number of vertices; 0 of null.
size_t rockproof_block_vertex_count(const struct RockproofBlock *block);

// The number of edges; 0 of null.
size_t rockproof_block_edge_count(const struct RockproofBlock *block);

// The number of faces; 0 of null.
size_t rockproof_block_face_count(const struct RockproofBlock *block);

// A vertex, to the nearest double. False where there is no such vertex, and `out` is left alone.
bool rockproof_block_vertex(const struct RockproofBlock *block, size_t vertex, struct RockproofPoint *out);

// The two vertices of an edge. False where there is no such edge, and `out` is left alone.
bool rockproof_block_edge(const struct RockproofBlock *block, size_t edge, struct RockproofEdge *out);

// The vertices of a face, counter-clockwise seen from outside, and their number in `length`; they are the block's, and gone with it. Null
// where there is no such face.
const uint32_t *rockproof_block_face(const struct RockproofBlock *block, size_t face, size_t *length);

// Whether all edges are convex; false of null.
bool rockproof_block_is_convex(const struct RockproofBlock *block);

// The volume in m³, to the nearest double; 0 of null.
double rockproof_block_volume(const struct RockproofBlock *block);

// The blocks of a file of any format that Rockproof reads. `planarity` as for `rockproof_block_new`, a negative number meaning what the file
// says; vertices no further apart than `weld` are joined, a negative number meaning none but those of STL that are one point. Null if the
// file or a block in it cannot be used. Free it with `rockproof_model_free`.
//
// # Safety
// `path` ends with a zero byte.
struct RockproofModel *rockproof_model_load(const char *path,
                                            double planarity,
                                            double weld);

// As `rockproof_model_load`, with every length multiplied by `scale` after vertices are joined, exactly: "1/1000" for a file in
// millimetres. Null, too, if that is no number above 0, or not 1 for a scene in TOML, which is in metres.
//
// # Safety
// `path` and `scale` end with a zero byte.
struct RockproofModel *rockproof_model_load_scaled(const char *path, double planarity, double weld, const char *scale);

// Frees a model; null is left alone. Blocks taken out of it stay.
void rockproof_model_free(struct RockproofModel *model);

// The number of blocks; 0 of null.
size_t rockproof_model_block_count(const struct RockproofModel *model);

// A block of a model, from 0. It is the caller's: free it with `rockproof_block_free`, before or after the model. Null where there is none.
struct RockproofBlock *rockproof_model_block(const struct RockproofModel *model, size_t number);

// Tolerances of a preset: "auto", "shi" or "zero". Null if it is none of them. Free them with `rockproof_tolerances_free`.
//
// # Safety
// `preset` ends with a zero byte.
struct RockproofTolerances *rockproof_tolerances_new(const char *preset);

// Sets one value in place of the preset's, exactly: "search=1/10", "overlap_angle=3", "criteria=classic". False if it cannot be, and
// nothing has changed. No other thread may use the tolerances meanwhile.
//
// # Safety
// `assignment` ends with a zero byte.
bool rockproof_tolerances_set(struct RockproofTolerances *tolerances, const char *assignment);

// Frees tolerances; null is left alone.
void rockproof_tolerances_free(struct RockproofTolerances *tolerances);

// The contacts of two blocks, found by `ROCKPROOF_EXACT`, `ROCKPROOF_F64` or `ROCKPROOF_F32`; the last two round blocks and tolerances to
// their precision first. Null tolerances are those of "auto". Null if a block does not survive rounding, or tolerances cannot be. Free them
// with `rockproof_contacts_free`.
struct RockproofContacts *rockproof_classify(const struct RockproofBlock *a,
                                             const struct RockproofBlock *b,
                                             const struct RockproofTolerances *tolerances,
                                             int32_t engine);

// Frees contacts; null is left alone.
void rockproof_contacts_free(struct RockproofContacts *contacts);

// The number of contacts; 0 of null.
size_t rockproof_contacts_count(const struct RockproofContacts *contacts);

// One of the contacts, from 0. False where there is none, and `out` is left alone.
bool rockproof_contacts_get(const struct RockproofContacts *contacts, size_t number, struct RockproofContact *out);

// The gap of a contact in metres as a fraction, "-1/3", which is exact; null where it is irrational, or there is no such contact. Of a float
// engine, the number that it calculated. The text is the contacts', and gone with them.
const char *rockproof_contacts_gap_exact(const struct RockproofContacts *contacts,
                                         size_t number);

// The square of the gap of a contact in m² as a fraction, which is exact whatever the gap is; null where there is no such contact.
const char *rockproof_contacts_gap_squared(const struct RockproofContacts *contacts, size_t number);

// How two convex blocks lie to one another, exactly: the distance, or minus the length of the shortest translation that parts them. Null
// where a block is concave or has more than 48 vertices. Free it with `rockproof_distance_free`.
struct RockproofDistance *rockproof_separation(const struct RockproofBlock *a, const struct RockproofBlock *b);

// How deep two blocks overlap, exactly: minus the depth, or 0. Of two convex blocks the shortest translation that parts them; of others
// the distance from the other's surface of the deepest vertex, or of the deepest middle of an edge within the other. Free it with
// `rockproof_distance_free`.
struct RockproofDistance *rockproof_penetration(const struct RockproofBlock *a, const struct RockproofBlock *b);

// Frees a distance; null is left alone.
void rockproof_distance_free(struct RockproofDistance *distance);

// 1 apart, 0 touching (or, of a penetration, not overlapping), -1 overlapping; 0 of null.
int32_t rockproof_distance_sign(const struct RockproofDistance *distance);

// The distance in metres to the nearest double, negative for an overlap; 0 of null.
double rockproof_distance_nearest(const struct RockproofDistance *distance);

// The distance in metres as a fraction, which is exact; null where it is irrational. The text is gone with the distance.
const char *rockproof_distance_exact(const struct RockproofDistance *distance);

// The square of the distance in m² as a fraction, which is exact whatever the distance is. The text is gone with the distance.
const char *rockproof_distance_squared(const struct RockproofDistance *distance);

// The rules that tolerances break for two blocks in double (`ROCKPROOF_F64`) or float (`ROCKPROOF_F32`). Null tolerances are those of
// "auto". Free the answer with `rockproof_check_free`.
struct RockproofCheck *rockproof_check(const struct RockproofBlock *a,
                                       const struct RockproofBlock *b,
                                       const struct RockproofTolerances *tolerances,
                                       int32_t engine);

// Frees a check; null is left alone.
void rockproof_check_free(struct RockproofCheck *check);

// The number of rules broken; 0 of null.
size_t rockproof_check_count(const struct RockproofCheck *check);

// A rule broken, from 0: what was found, what is allowed, what would satisfy it, and why there is the rule. Null where there is none. The
// text is gone with the check.
const char *rockproof_check_text(const struct RockproofCheck *check, size_t number);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ROCKPROOF_H */
