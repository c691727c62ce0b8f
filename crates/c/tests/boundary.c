/* What C may do wrong: every call answers with null, false or 0 and a text, and nothing crashes. */
#include "rockproof.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static int failed = 0;

static void said(const char *what, int null, const char *part) {
    const char *error = rockproof_last_error();
    if (!null || error == NULL || strstr(error, part) == NULL) {
        printf("%s: %s\n", what, error ? error : "no error");
        failed = 1;
    }
}

static void holds(const char *what, int is) {
    if (!is) {
        printf("%s\n", what);
        failed = 1;
    }
}

int main(void) {
    double at[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    uint32_t corners[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    uint32_t lengths[4] = {3, 3, 3, 3};
    RockproofBlock *block = rockproof_block_new(at, 4, corners, lengths, 4, -1);
    holds("a tetrahedron", block != NULL && rockproof_last_error() == NULL && rockproof_block_face_count(block) == 4);
    holds("its numbers", rockproof_block_vertex_count(block) == 4 && rockproof_block_edge_count(block) == 6);
    holds("its shape", rockproof_block_is_convex(block) && fabs(rockproof_block_volume(block) - 1.0 / 6) < 1e-16);
    RockproofPoint point;
    RockproofEdge edge;
    size_t length = 0;
    holds("a vertex", rockproof_block_vertex(block, 3, &point) && point.z == 1.0 && !rockproof_block_vertex(block, 4, &point));
    holds("an edge", rockproof_block_edge(block, 0, &edge) && edge.p == 0 && edge.q == 1 && !rockproof_block_edge(block, 6, &edge));
    const uint32_t *face = rockproof_block_face(block, 0, &length);
    holds("a face", face != NULL && length == 3 && face[1] == 2 && rockproof_block_face(block, 4, &length) == NULL);
    holds("a place that is null", !rockproof_block_vertex(block, 0, NULL) && rockproof_block_face(block, 0, NULL) == NULL);

    said("null vertices", rockproof_block_new(NULL, 4, corners, lengths, 4, -1) == NULL, "vertices is null");
    said("null faces", rockproof_block_new(at, 4, NULL, lengths, 4, -1) == NULL, "face_vertices is null");
    said("no faces", rockproof_block_new(at, 4, corners, lengths, 0, -1) == NULL, "at least 4 vertices and 4 faces");
    said("too many", rockproof_block_new(at, SIZE_MAX, corners, lengths, 4, -1) == NULL, "more than a memory holds");
    said("planarity", rockproof_block_new(at, 4, corners, lengths, 4, NAN) == NULL, "planarity");
    corners[0] = 9;
    said("a vertex that is not", rockproof_block_new(at, 4, corners, lengths, 4, -1) == NULL, "face 0 names vertex 9");
    at[0] = INFINITY;
    said("infinity", rockproof_block_new(at, 4, corners, lengths, 4, -1) == NULL, "vertex 0");

    said("no file", rockproof_model_load("nothing.stl", -1, -1) == NULL, "nothing.stl:");
    said("no path", rockproof_model_load(NULL, -1, -1) == NULL, "path is null");
    said("no text", rockproof_model_load("\xff.stl", -1, -1) == NULL, "UTF-8");
    FILE *file = fopen("millimetres.obj", "w");
    fputs("v 0 0 0\nv 1000 0 0\nv 0 1000 0\nv 0 0 1000\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", file);
    fclose(file);
    RockproofModel *model = rockproof_model_load_scaled("millimetres.obj", -1, -1, "1/1000");
    RockproofBlock *scaled = rockproof_model_block(model, 0);
    holds("a file in millimetres", fabs(rockproof_block_volume(scaled) - 1.0 / 6) < 1e-16);
    rockproof_block_free(scaled);
    rockproof_model_free(model);
    said("no scale", rockproof_model_load_scaled("millimetres.obj", -1, -1, NULL) == NULL, "scale is null");
    said("a scale that is 0", rockproof_model_load_scaled("millimetres.obj", -1, -1, "0") == NULL, "scale is 0; allowed is");
    said("a scale that is none", rockproof_model_load_scaled("millimetres.obj", -1, -1, "mm") == NULL, "scale: ");
    said("no model", rockproof_model_block(NULL, 0) == NULL, "model is null");
    said("no preset", rockproof_tolerances_new("strict") == NULL, "strict");
    RockproofTolerances *tolerances = rockproof_tolerances_new("zero");
    said("no value", !rockproof_tolerances_set(tolerances, "search=-1"), "search");
    said("no tolerances", !rockproof_tolerances_set(NULL, "search=1"), "null");
    said("no engine", rockproof_classify(block, block, tolerances, 7) == NULL, "engine is 7");
    said("no block", rockproof_classify(block, NULL, NULL, ROCKPROOF_EXACT) == NULL, "block b is null");
    said("rules of nothing", rockproof_check(block, block, NULL, ROCKPROOF_EXACT) == NULL, "ROCKPROOF_F64");
    said("no pair", rockproof_penetration(NULL, block) == NULL, "block a is null");

    RockproofDistance *depth = rockproof_penetration(block, block);
    holds("the depth of a block in itself", rockproof_distance_sign(depth) == -1 && rockproof_distance_nearest(depth) < 0);
    holds("of null", rockproof_distance_sign(NULL) == 0 && rockproof_distance_exact(NULL) == NULL && rockproof_contacts_count(NULL) == 0
                         && rockproof_check_text(NULL, 0) == NULL && rockproof_model_block_count(NULL) == 0);
    rockproof_distance_free(depth);
    rockproof_tolerances_free(tolerances);
    rockproof_block_free(block);
    rockproof_block_free(NULL);
    rockproof_model_free(NULL);
    rockproof_contacts_free(NULL);
    rockproof_distance_free(NULL);
    rockproof_check_free(NULL);
    rockproof_tolerances_free(NULL);
    if (!failed) {
        printf("rockproof %s: good\n", rockproof_version());
    }
    return failed;
}
