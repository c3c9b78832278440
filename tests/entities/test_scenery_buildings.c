/* Buildings of a culture as meshes: closed shells, heights, areas and volumes against closed forms, and outlines of any
 * kind. labels: physics */
#include "tests/entities/buildings_fixture.h"

static const double rectangle[4][2] = {{10, 10}, {22, 10}, {22, 18}, {10, 18}};

static void check_closed(const Scenery *s)
{
    for (int k = 0; k < s->models; k++) {
        const Model *m = &s->model[k];
        CHECK(model_check(m) == STATUS_OK);
        for (int first = 0, end; first < m->part_count; first = end) {
            const uint64_t *id = s->part_of + s->part_first[k];
            for (end = first + 1; end < m->part_count && id[end] == id[first];) end++;
            Model        one = whole(m, first, end);
            const Status status = model_validate(&one);
            if (status != STATUS_OK) {
                print_message("building %llu\n", (unsigned long long)id[first]);
                if (getenv("DUMP"))
                    for (int t = 0; t < 3 * one.triangle_count; t++) {
                        const double *a = m->vertex[one.triangle[t / 3][t % 3]],
                                     *b = m->vertex[one.triangle[t / 3][(t + 1) % 3]];
                        int bal = 0;
                        for (int u = 0; u < 3 * one.triangle_count; u++) {
                            const double *c = m->vertex[one.triangle[u / 3][u % 3]],
                                         *d = m->vertex[one.triangle[u / 3][(u + 1) % 3]];
                            bal += !memcmp(a, c, 24) && !memcmp(b, d, 24);
                            bal -= !memcmp(a, d, 24) && !memcmp(b, c, 24);
                        }
                        if (bal)
                            print_message("%s: %.9f %.9f %.9f -> %.9f %.9f %.9f\n",
                                          m->part[m->triangle_part[m->part[first].first_triangle + t / 3]].name, a[0],
                                          a[1], a[2], b[0], b[1], b[2]);
                    }
            }
            if (!getenv("DUMP")) CHECK(status == STATUS_OK);
            whole_free(&one);
        }
    }
}

static void every_roof_closes_every_outline(void **state)
{
    (void)state;
    static const double ell[6][2] = {{0, 0}, {14, 0}, {14, 7}, {7, 7}, {7, 15}, {0, 15}};
    static const double u[8][2] = {{0, 0}, {20, 0}, {20, 15}, {14, 15}, {14, 6}, {6, 6}, {6, 15}, {0, 15}};
    static const double tee[8][2] = {{0, 0}, {18, 0}, {18, 6}, {12, 6}, {12, 14}, {6, 14}, {6, 6}, {0, 6}};
    static const double triangle[3][2] = {{0, 0}, {12, 1}, {4, 9}};
    static const double square[4][2] = {{0, 0}, {9, 0}, {9, 9}, {0, 9}};
    static const double cross[12][2] = {{5, 0},   {10, 0}, {10, 5}, {15, 5}, {15, 10}, {10, 10},
                                        {10, 15}, {5, 15}, {5, 10}, {0, 10}, {0, 5},   {5, 5}};
    static const struct {
        const double (*p)[2];
        int n;
    } outline[] = {{rectangle, 4}, {ell, 6}, {u, 8}, {tee, 8}, {triangle, 3}, {square, 4}, {cross, 12}};
    for (int o = 0; o < 7; o++)
        for (int roof = 0; roof < ROOF_SHAPES; roof++)
            for (int use = 0; use < BUILDING_USES; use++) {
                Culture  c = {0};
                Building b = house;
                b.roof = (uint8_t)roof, b.use = (uint8_t)use, b.id = (uint64_t)(100 * o + 10 * roof + use);
                b.chimneys = 2;
                add(&c, &b, outline[o].p, outline[o].n);
                Scenery s = scenery_of(&c);
                assert_int_equal(s.models, 1);
                check_closed(&s);
                const Model *m = &s.model[0];
                double       high = 0;
                for (int t = 0; t < m->triangle_count; t++)
                    for (int k = 0; k < 3 && strcmp(m->part[m->triangle_part[t]].name, "chimney"); k++)
                        high = fmax(high, -m->vertex[m->triangle[t][k]][2]);
                if (use != BUILDING_HALL) CHECK_NEAR(high, 9, 1e-6);
                scenery_free(&s);
                culture_free(&c);
            }
}

/* A simple outline of a kind and seed: a star of random radii; steps of a staircase; a comb of wings. */
static int random_outline(double (*p)[2], uint64_t seed)
{
    const double x0 = (double)(seed % 100) * 128 + 64, y0 = (double)(seed / 100) * 128 + 64;
    const int    kind = (int)(4 * random_uniform(seed, 1, 0, 0));
    const double turn = kind == 3 ? 0 : 6.3 * random_uniform(seed, 1, 0, 1), c = cos(turn), s = sin(turn);
    int          n = 0;
    if (kind == 0) {
        n = 3 + (int)(random_uniform(seed, 1, 0, 2) * 20);
        for (int k = 0; k < n; k++) {
            const double a = 2 * pi_rad * (k + 0.8 * random_uniform(seed, 2, 0, (uint64_t)k)) / n;
            const double r = 3 + 15 * random_uniform(seed, 3, 0, (uint64_t)k);
            p[k][0] = r * cos(a), p[k][1] = r * sin(a);
        }
    } else {
        const int wings = 1 + (int)(random_uniform(seed, 1, 0, 2) * 6);
        double    x = 0;
        p[n][0] = 0, p[n++][1] = 0;
        for (int k = 0; k < wings; k++) {
            /* whole metres in kind 2 and 3: many events at once */
            const double u = 2 + 8 * random_uniform(seed, 2, 0, (uint64_t)k),
                         v = 4 + 12 * random_uniform(seed, 3, 0, (uint64_t)k);
            const double wide = kind > 1 ? 1 + floor(u) : u, high = kind > 1 ? floor(v) : v;
            p[n][0] = x, p[n++][1] = -high;
            x += wide;
            p[n][0] = x, p[n++][1] = -high;
        }
        p[n][0] = x, p[n++][1] = 0;
    }
    for (int k = 0; k < n; k++) {
        const double x = p[k][0], y = p[k][1];
        p[k][0] = x0 + c * x - s * y, p[k][1] = y0 + s * x + c * y;
    }
    return n;
}

static void any_outline_is_closed_and_sound(void **state)
{
    (void)state;
    Culture c = {0};
    for (uint64_t seed = 0; seed < 10000; seed++) {
        double   p[64][2];
        Building b = house;
        b.id = seed + 1;
        b.roof = (uint8_t)(seed % ROOF_SHAPES), b.use = (uint8_t)(seed / 5 % BUILDING_USES);
        b.ridge_rad = (float)(6.3 * random_uniform(seed, 1, 0, 1));
        b.eaves_m = (float)(2.2 + 8 * random_uniform(seed, 4, 0, 0));
        b.ridge_m = b.eaves_m + (float)(5 * random_uniform(seed, 4, 0, 1));
        b.damage = (uint8_t)(seed % 7 < 4 ? 0 : seed % 7 - 3), b.levels = (uint8_t)(1 + seed % 4),
        b.chimneys = (uint8_t)(seed % 5);
        CHECK(culture_add_building(&c, &b, (const double(*)[2])p, random_outline(p, seed)) == STATUS_OK);
    }
    print_message("%d buildings, %d left out\n", c.buildings, c.left_out);
    Scenery s = scenery_of(&c);
    check_closed(&s);
    double least = INFINITY;
    int    flat = 0;
    for (int k = 0; k < s.models; k++) {
        const Model *m = &s.model[k];
        for (int t = 0; t < m->triangle_count; t++) {
            double u[3], v[3], n[3];
            v3_sub(u, m->vertex[m->triangle[t][1]], m->vertex[m->triangle[t][0]]);
            v3_sub(v, m->vertex[m->triangle[t][2]], m->vertex[m->triangle[t][0]]);
            v3_cross(n, u, v);
            const double area = 0.5 * sqrt(v3_dot(n, n));
            if (!(area > 1e-9))
                print_message("model %s part %s area %g\n", m->name, m->part[m->triangle_part[t]].name, area);
            least = fmin(least, area);
        }
        const uint64_t  id = s.part_of[s.part_first[k]] - 1;
        const Building *b = NULL;
        for (int q = 0; q < c.buildings && !b; q++)
            if (c.building[q].id == id + 1) b = &c.building[q];
        double high = 0;
        for (int t = 0; t < m->triangle_count; t++)
            for (int q = 0; q < 3 && !strcmp(m->part[m->triangle_part[t]].name, "roof"); q++)
                high = fmax(high, -m->vertex[m->triangle[t][q]][2]);
        if (b->damage < 3 && b->roof && b->use != BUILDING_HALL && b->ridge_m - b->eaves_m > 0.1F &&
            high < b->ridge_m - 1e-3F) {
            if (flat++ < 10)
                print_message("flat: seed %d roof %d corners %d: %g of %g\n", (int)id, b->roof, b->corners, high,
                              (double)b->ridge_m);
        }
    }
    print_message("least area %g; flat instead %d\n", least, flat);
    scenery_free(&s);
    culture_free(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_outline_is_closed_and_sound),
        cmocka_unit_test(every_roof_closes_every_outline),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
