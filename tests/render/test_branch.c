/* Trunks over a day: the three parts by sides against finite volumes over rings and sides, with every side's own
 * balance. Closed forms: test_branch_balance.c. labels: physics */
#include "tests/scenes/paper_day.h"

enum { rings = 12, sides = 24 };

static const BranchKind pine = {1, 0.2, 550 * 2000.0, 0.7, 0.95};

/* Conduction in a cylinder of equal rings, explicit; t[ring][side], outermost last. */
typedef struct Disc {
    double t_k[rings][sides], face_k[sides];
} Disc;

static void disc_step(Disc *d, double radius_m, const GroundWeather *w, double sun, double ground_k, double dt_s)
{
    static Disc  old;
    const double dr = radius_m / rings, turn = 2 * pi_rad / sides, k = pine.conductivity_w_mk, c = pine.capacity_j_m3k;
    const double film = heat_branch_film_w_m2k(radius_m, w->air.wind_mps);
    old = *d;
    for (int s = 0; s < sides; s++) {
        const double n[3] = {cos(s * turn), sin(s * turn), 0},
                     along = w->sun_d_enu[2] > 0 ? fmax(v3_dot(n, w->sun_d_enu), 0) : 0;
        const double direct = sun * w->direct_w_m2,
                     below = 0.15 * ((w->sun_d_enu[2] > 0 ? direct * w->sun_d_enu[2] : 0) + w->diffuse_w_m2);
        const double gain = pine.absorptance * (direct * along + 0.5 * w->diffuse_w_m2 + 0.5 * below) +
                            pine.emissivity * 0.5 * (w->longwave_w_m2 + stefan_w_m2k4 * pow(ground_k, 4));
        const double face = 2 * k / dr;
        for (int i = 0; i < 6; i++) {
            const double t = d->face_k[s], t3 = t * t * t;
            const double miss = gain - film * (t - w->air.temp_k) - pine.emissivity * stefan_w_m2k4 * t * t3 -
                                face * (t - old.t_k[rings - 1][s]);
            d->face_k[s] += miss / (film + face + 4 * pine.emissivity * stefan_w_m2k4 * t3);
        }
        for (int r = 0; r < rings; r++) {
            const double middle = (r + 0.5) * dr, volume = middle * dr * turn;
            double       heat = r + 1 < rings ? k * (r + 1) * dr * turn / dr * (old.t_k[r + 1][s] - old.t_k[r][s])
                                              : face * radius_m * turn * (d->face_k[s] - old.t_k[r][s]);
            if (r > 0) heat += k * r * dr * turn / dr * (old.t_k[r - 1][s] - old.t_k[r][s]);
            heat += k * dr / (middle * turn) *
                    (old.t_k[r][(s + 1) % sides] + old.t_k[r][(s + sides - 1) % sides] - 2 * old.t_k[r][s]);
            d->t_k[r][s] += dt_s * heat / (c * volume);
        }
    }
}

static void sides_of_a_trunk(void **state)
{
    (void)state;
    static const double radius_m[] = {0.04, 0.12};
    for (int k = 0; k < 2; k++) {
        static Disc  disc;
        Branch       branch;
        double       worst = 0, sum = 0, range[2] = {400, 0};
        int          count = 0;
        const double dt_s = radius_m[k] < 0.1 ? 0.25 : 3;
        for (int s = 0; s < sides; s++) {
            disc.face_k[s] = 288;
            for (int r = 0; r < rings; r++) disc.t_k[r][s] = 288;
        }
        heat_branch_start(&branch, &pine, radius_m[k], 288);
        const double days = radius_m[k] < 0.1 ? 1.2 : 2;
        double       t_s = 0;
        for (int step = 0; step < (int)(days * 144); step++) {
            GroundWeather w;
            for (double until_s = (step + 1) * 600.0; t_s < until_s - 1e-6; t_s += dt_s) {
                if (fmod(t_s, 60) < dt_s) paper_weather(&w, paper_unix_s + t_s, &paper_summer);
                disc_step(&disc, radius_m[k], &w, 1, 288, dt_s);
            }
            paper_weather(&w, paper_unix_s + t_s, &paper_summer);
            heat_branch_step(&branch, &w, 1, 288, 600);
            if (t_s < (days - 1) * 86400) continue;
            BranchSides b;
            heat_branch_sides(&b, &branch);
            for (int s = 0; s < sides; s++) {
                const double n[3] = {cos(s * 2 * pi_rad / sides), sin(s * 2 * pi_rad / sides), 0};
                const double miss = branch_side_k(&b, n) - disc.face_k[s];
                worst = fmax(worst, fabs(miss)), sum += miss * miss, count++;
                range[0] = fmin(range[0], disc.face_k[s]), range[1] = fmax(range[1], disc.face_k[s]);
            }
        }
        print_message("radius %.0f mm: %.1f to %.1f K over the day and its sides; %.2f K rms, %.2f K worst\n",
                      1e3 * radius_m[k], range[0], range[1], sqrt(sum / count), worst);
        CHECK(range[1] - range[0] > 15);
        CHECK(sqrt(sum / count) < 0.8 && worst < 3);
    }
}

/* A thin branch follows the air and the sun at once, a thick one late; shade takes the side. */
static void thin_and_thick(void **state)
{
    (void)state;
    Branch thin, thick, shaded;
    heat_branch_start(&thin, &pine, branch_radius_m[0], 288);
    heat_branch_start(&thick, &pine, branch_radius_m[branch_radii - 1], 288);
    heat_branch_start(&shaded, &pine, branch_radius_m[branch_radii - 1], 288);
    double at_h[2] = {0}, most[2] = {0};
    for (int step = 0; step < 288; step++) {
        GroundWeather w;
        paper_weather(&w, paper_unix_s + 600 * (step + 1), &paper_summer);
        heat_branch_step(&thin, &w, 1, 288, 600);
        heat_branch_step(&thick, &w, 1, 288, 600);
        heat_branch_step(&shaded, &w, 0, 288, 600);
        const Branch *both[2] = {&thin, &thick};
        for (int k = 0; k < 2 && step >= 144; k++)
            if (both[k]->face_k[0] > most[k]) most[k] = both[k]->face_k[0], at_h[k] = (step + 1 - 144) / 6.0;
        if (step == 144 + 60) { /* ten: the sun in the south east */
            BranchSides lit, dark;
            heat_branch_sides(&lit, &thick), heat_branch_sides(&dark, &shaded);
            const double south_east[3] = {0.7, -0.7, 0}, north_west[3] = {-0.7, 0.7, 0};
            CHECK(branch_side_k(&lit, south_east) > branch_side_k(&lit, north_west) + 5);
            CHECK(fabs(branch_side_k(&dark, south_east) - branch_side_k(&dark, north_west)) < 1e-6);
        }
    }
    print_message("warmest: thin %.1f h, thick %.1f h\n", at_h[0], at_h[1]);
    CHECK(at_h[1] > at_h[0] + 0.5 && most[0] > 288);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(sides_of_a_trunk), cmocka_unit_test(thin_and_thick)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
