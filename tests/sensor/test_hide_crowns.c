/* What an exercise knows of crowns, which it may not grow, against the prototypes themselves: radius and density of
 * each slice of their height. */
#include "entities/exercise/hide.h"
#include "render/trace/plants/plants.h"
#include "tests/check.h"

#include <stdlib.h>

typedef struct Piece {
    double off_m, area_m2; /* from the axis; that a ray from anywhere meets, in the mean */
} Piece;

static int by_off(const void *a, const void *b)
{
    const double x = ((const Piece *)a)->off_m, y = ((const Piece *)b)->off_m;
    return (x > y) - (x < y);
}

/* Half of a leaf's side and a quarter of a branch's skin are seen from a side drawn at random (Cauchy). */
static int pieces_of(Piece *out, const Plants *plants, PlantKind kind, int slice)
{
    const PlantShape *s = &plants->shape[kind][plant_whole];
    int               count = 0;
    for (int q = 0; q < s->quads; q++) {
        const PlantQuad *quad = &s->quad[q];
        double           u[3], v[3], n[3], middle[3] = {0};
        for (int k = 0; k < 3; k++) {
            u[k] = (double)quad->corner[1][k] - (double)quad->corner[0][k];
            v[k] = (double)quad->corner[3][k] - (double)quad->corner[0][k];
            for (int c = 0; c < 4; c++) middle[k] += 0.25 * (double)quad->corner[c][k];
        }
        if ((int)(middle[2] * 8) != slice) continue;
        v3_cross(n, u, v);
        const double share = q < s->bark_quads ? 0.25 : 0.5 * (double)plants->outline_area[kind][quad->outline];
        out[count++] = (Piece){hypot(middle[0], middle[1]), share * v3_length(n)};
    }
    return count;
}

static void crowns_are_those_of_the_prototypes(void **state)
{
    (void)state;
    Plants *plants;
    assert_int_equal(plants_create(&plants, plants_seed, NULL), STATUS_OK);
    for (int kind = 0; kind < PLANT_STANDING; kind++) {
        Piece *piece = calloc((size_t)plants->shape[kind][plant_whole].quads + 1, sizeof *piece);
        double want_sum = 0, got_sum = 0;
        for (int slice = 0; slice < 8; slice++) {
            double    sum = 0, part = 0, off_m = 0, radius_m, per_m;
            const int count = pieces_of(piece, plants, (PlantKind)kind, slice);
            qsort(piece, (size_t)count, sizeof *piece, by_off);
            for (int n = 0; n < count; n++) sum += piece[n].area_m2;
            for (int n = 0; n < count && part < 0.9 * sum; n++) part += piece[n].area_m2, off_m = piece[n].off_m;
            hide_crown(&radius_m, &per_m, (PlantKind)kind, slice);
            CHECK_NEAR(radius_m, off_m, 0.001); /* as printed */
            got_sum += per_m * pi_rad * radius_m * radius_m / 8, want_sum += part;
        }
        CHECK_NEAR(got_sum, want_sum, 0.03 * want_sum);
        free(piece);
    }
    plants_destroy(plants);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(crowns_are_those_of_the_prototypes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
