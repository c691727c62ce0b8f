/* Two boxes, one on the other and a third of a metre into it: contacts exactly and in float, and how deep they overlap. */
#include "rockproof.h"
#include <stdio.h>
#include <stdlib.h>

static RockproofBlock *box(const double min[3], const double max[3]) {
    double vertices[24];
    for (int i = 0; i < 8; i++) {
        vertices[3 * i] = (i == 1 || i == 2 || i == 5 || i == 6) ? max[0] : min[0];
        vertices[3 * i + 1] = (i & 2) ? max[1] : min[1];
        vertices[3 * i + 2] = (i & 4) ? max[2] : min[2];
    }
    const uint32_t corners[24] = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7};
    const uint32_t lengths[6] = {4, 4, 4, 4, 4, 4};
    return rockproof_block_new(vertices, 8, corners, lengths, 6, -1.0);
}

static void *or_die(void *handle) {
    if (handle == NULL) {
        fprintf(stderr, "%s\n", rockproof_last_error());
        exit(2);
    }
    return handle;
}

int main(void) {
    RockproofBlock *lower = or_die(box((double[]){0, 0, 0}, (double[]){2, 2, 1}));
    RockproofBlock *upper = or_die(box((double[]){0.5, 0.5, 0.875}, (double[]){1.5, 1.5, 2}));
    RockproofTolerances *tolerances = or_die(rockproof_tolerances_new("auto"));
    if (!rockproof_tolerances_set(tolerances, "penetration=1/4")) {
        or_die(NULL);
    }
    const int32_t engines[2] = {ROCKPROOF_EXACT, ROCKPROOF_F32};
    for (int e = 0; e < 2; e++) {
        RockproofContacts *contacts = or_die(rockproof_classify(lower, upper, tolerances, engines[e]));
        printf("%s: %zu contacts\n", e == 0 ? "exact" : "f32", rockproof_contacts_count(contacts));
        RockproofContact contact;
        for (size_t i = 0; rockproof_contacts_get(contacts, i, &contact); i++) {
            const char *exact = rockproof_contacts_gap_exact(contacts, i);
            printf("  kind %d, features %u and %u, gap %g m, exactly %s m\n", (int)contact.kind, contact.feature_a,
                   contact.feature_b, contact.gap, exact ? exact : "irrational");
        }
        rockproof_contacts_free(contacts);
    }
    RockproofDistance *separation = or_die(rockproof_separation(lower, upper));
    printf("separation: %s m\n", rockproof_distance_exact(separation));
    RockproofCheck *check = or_die(rockproof_check(lower, upper, tolerances, ROCKPROOF_F64));
    printf("rules broken: %zu\n", rockproof_check_count(check));
    for (size_t i = 0; i < rockproof_check_count(check); i++) {
        printf("  %s\n", rockproof_check_text(check, i));
    }
    rockproof_check_free(check);
    rockproof_distance_free(separation);
    rockproof_tolerances_free(tolerances);
    rockproof_block_free(upper);
    rockproof_block_free(lower);
    return 0;
}
