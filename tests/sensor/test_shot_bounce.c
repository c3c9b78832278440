/* The echoes of an entity by way of the ground in one shot: a metal sphere above a plane that mirrors by Fresnel's
 * formulas, against image theory worked out in vectors; and what takes the ground's echoes away. labels: physics */
#include "tests/sensor/radar_scene.h"

#include "sensor/radar/seeker_radar_private.h"

static const double sphere_m = 0.3, high_m = 20, target_m = 6, away_m = 300;

static Landscape      land;
static SeekerRadar   *radar;
static double complex sample[interval_channels * 128 * 512];

static int open_stage(void **state)
{
    (void)state;
    LandscapeConfig config = landscape_default_config();
    config.half_width_m = 500;
    config.horizon_m = 20000;
    config.relief_m = 0;
    scene_folder();
    FILE *file = scene_obj("sphere", NULL);
    scene_sphere(file, 1, sphere_m, 0, 0, 0);
    CHECK(fclose(file) == 0);
    scene_open((const char *const[]){"sphere"}, 1);
    CHECK(landscape_create(&land, &config, &stage.world.frame, NULL, 0, NULL, 0) == STATUS_OK);
    stage.world.landscape = &land;
    CHECK(seeker_radar_create(&radar, &(SeekerRadarConfig){.preset = "search_ku",
                                                           .catalog = stage.catalog_path,
                                                           .isa = "avx2",
                                                           .ground_bounce = true,
                                                           .chaff_dipoles = 3e6,
                                                           .seed = 1}) == STATUS_OK);
    /* all ground of eps 4 - j, 5 mm rms */
    for (int s = 0; s < SURFACE_COUNT; s++) radar->mirror.row[s] = (GroundRow){1, {16e9}, {4}, {1}, 5e-3, false};
    return 0;
}

static int close_stage(void **state)
{
    (void)state;
    seeker_radar_destroy(radar);
    landscape_destroy(&land);
    scene_close();
    return 0;
}

/* A shot at a sphere, rolled by 25 degrees, its axis between the direct path and that by the ground. */
typedef struct Case {
    RadarShot   shot;
    RadarFrame  frame;
    Target      target;
    Visibility *visibility;
    NodePose    pose[4];
    double      joint[4];
    double      p_ground[3], n[3]; /* of the plane at the reflection */
} Case;

static double ground_at(double x, double y, double n[3]) { return elevation_height(&land.elevation, x, y, n); }

static void set_up(Case *c, bool h)
{
    static const double turned[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1}; /* forward north, right east, down */
    const double        el = -3.6 * rad_per_deg, az = 0.3 * rad_per_deg, roll = 25 * rad_per_deg;
    *c = (Case){0};
    stage.snapshot.count = 0;
    radar->preset.transmits_h = h;
    SnapshotEntity *e = scene_add(0, 3, away_m, ground_at(3, away_m, NULL) + target_m);
    m3_mul(e->r_ecef_from_body, stage.world.frame.r_ecef_from_enu, turned);
    const double antenna[3] = {0, 0, ground_at(0, 0, NULL) + high_m}, v_enu[3] = {30, -20, -40},
                 v_target[3] = {5, -8, 2};
    m3_mul_v3(e->v_ecef_mps, stage.world.frame.r_ecef_from_enu, v_target);
    memcpy(stage.view.p_enu, antenna, sizeof antenna);
    memcpy(stage.scene.v_enu_mps, v_enu, sizeof v_enu);
    CHECK(visibility_create(&c->visibility, stage.world.tracer, &land, &stage.world.frame, &stage.snapshot, 0,
                            stage.arena) == STATUS_OK);
    RadarShot *s = &c->shot;
    *s = (RadarShot){.radar = radar,
                     .scene = &stage.scene,
                     .preset = &radar->preset,
                     .visibility = c->visibility,
                     .frame = &c->frame,
                     .arena = stage.arena,
                     .reference_m = 299,
                     .reference_rate_mps = 11,
                     .half_window_m = 512 * light_mps / (4 * 20e6),
                     .reach = 1,
                     .widest = 0.1,
                     .air_np_m = 5e-4};
    const double right[3] = {cos(az), -sin(az), 0};
    double       down[3];
    s->ahead[0] = cos(el) * sin(az), s->ahead[1] = cos(el) * cos(az), s->ahead[2] = sin(el);
    v3_cross(down, s->ahead, right);
    for (int k = 0; k < 3; k++) {
        s->p_enu[k] = antenna[k];
        s->right[k] = cos(roll) * right[k] + sin(roll) * down[k];
        s->down[k] = cos(roll) * down[k] - sin(roll) * right[k];
    }
    Target *t = &c->target;
    *t = (Target){.entity = e, .joint = c->joint};
    Origin origin;
    t->model = catalog_find(radar->catalog, e->type, &origin, NULL);
    t->of = catalog_model(radar->catalog, t->model);
    CHECK(t->of->node_count <= 4);
    model_pose(c->pose, t->of, NULL);
    t->pose = c->pose;
    enu_from_ecef(t->p_enu, &stage.world.frame, e->p_ecef);
    memcpy(t->v_enu_mps, v_target, sizeof v_target);
    memcpy(t->r_enu_from_body, turned, sizeof turned);
    radar_antenna(&t->antenna, s->p_enu, t->p_enu, t->r_enu_from_body);
    /* the reflection lies between the feet of both as their heights share the way; the ground sinks by 7 mm over it */
    const double share = high_m / (high_m + target_m);
    c->p_ground[0] = 3 * share, c->p_ground[1] = away_m * share;
    c->p_ground[2] = ground_at(c->p_ground[0], c->p_ground[1], c->n);
}

/* What image theory has of the case. */
typedef struct Paper {
    double         d_m, i_m, d_mps, i_mps; /* ways from antenna and image: length and rate */
    double         sine, off;              /* of the grazing angle; of the reflection off the axis */
    double         gain_d[3], gain_i[3];   /* sum, right, down */
    double complex te, tm;
    double complex a[2][2][2][2]; /* [out by the ground][back by it][received axis][sent axis], m */
} Paper;

/* Field at the target of a wave of unit field along an axis of the antenna: u from the target to where it comes from.
 */
static void leg_fields(double complex e[2][3], const Case *c, const double u[3], const Paper *p, bool image)
{
    double from[3], axis[2][3], across[3], before[3], after[3];
    v3_add_scaled(from, u, image ? -2 * v3_dot(u, c->n) : 0, c->n); /* to the antenna from the ground */
    v3_add_scaled(axis[0], c->shot.right, -v3_dot(c->shot.right, from), from);
    v3_normalize(axis[0], axis[0]);
    v3_cross(axis[1], from, axis[0]);
    v3_cross(across, c->n, u);
    v3_normalize(across, across);
    v3_cross(before, from, across);
    v3_cross(after, u, across);
    for (int a = 0; a < 2; a++)
        for (int k = 0; k < 3; k++)
            e[a][k] = image ? p->te * v3_dot(axis[a], across) * across[k] + p->tm * v3_dot(axis[a], before) * after[k]
                            : axis[a][k];
}

static Paper paper_of(const Case *c)
{
    Paper            p;
    const RadarShot *s = &c->shot;
    double           place[2][3], v[2][3], u[2][3], d[3];
    double complex   e[2][2][3];
    const double     k = 2 * pi_rad * 16.5e9 / light_mps;
    v3_sub(d, s->p_enu, c->p_ground);
    memcpy(place[0], s->p_enu, sizeof place[0]);
    v3_add_scaled(place[1], s->p_enu, -2 * v3_dot(d, c->n), c->n);
    memcpy(v[0], stage.scene.v_enu_mps, sizeof v[0]);
    v3_add_scaled(v[1], v[0], -2 * v3_dot(v[0], c->n), c->n);
    for (int way = 0; way < 2; way++) {
        double rate[3];
        v3_sub(u[way], place[way], c->target.p_enu);
        *(way ? &p.i_m : &p.d_m) = v3_length(u[way]);
        v3_normalize(u[way], u[way]);
        v3_sub(rate, v[way], c->target.v_enu_mps);
        *(way ? &p.i_mps : &p.d_mps) = v3_dot(rate, u[way]);
        v3_add_scaled(d, u[way], way ? -2 * v3_dot(u[way], c->n) : 0, c->n);
        const AntennaGain g = antenna_gain(&radar->preset.antenna, -v3_dot(d, s->right), -v3_dot(d, s->down));
        memcpy(way ? p.gain_i : p.gain_d, (double[3]){g.sum, g.right, g.down}, sizeof p.gain_d);
        if (way) p.off = hypot(v3_dot(d, s->right), v3_dot(d, s->down));
    }
    /* Fresnel's coefficients of a half space, and exp(-2 (k rms sine)^2) of its roughness (Ament) */
    p.sine = -v3_dot(u[1], c->n);
    const double complex eps = 4 - I, q = csqrt(eps - (1 - p.sine * p.sine));
    const double         rough = exp(-2 * pow(k * 5e-3 * p.sine, 2));
    p.te = rough * (p.sine - q) / (p.sine + q);
    p.tm = rough * (eps * p.sine - q) / (eps * p.sine + q);
    for (int way = 0; way < 2; way++) leg_fields(e[way], c, u[way], &p, way);
    /* geometrical optics of a metal sphere: a / 2, E turned about the normal where it mirrors; the path is shorter than
     * that over the middle by twice the radius times the normal's cosine */
    for (int out = 0; out < 2; out++)
        for (int back = 0; back < 2; back++) {
            double n[3];
            v3_add(n, u[out], u[back]);
            const double         cosine = 0.5 * v3_length(n);
            const double complex size = 0.5 * sphere_m * cexp(2 * I * k * sphere_m * cosine);
            v3_normalize(n, n);
            for (int r = 0; r < 2; r++)
                for (int t = 0; t < 2; t++) {
                    double complex along[2] = {0, 0}, dot = 0;
                    for (int x = 0; x < 3; x++) {
                        along[0] += n[x] * e[out][t][x];
                        along[1] += n[x] * e[back][r][x];
                        dot += e[out][t][x] * e[back][r][x];
                    }
                    p.a[out][back][r][t] = size * (2 * along[0] * along[1] - dot);
                }
        }
    return p;
}

static Status bounce(Case *c, RadarTruth *truth, const Paper *p, int own)
{
    const ScatterMatrix direct = {.hh = -0.5 * sphere_m * cexp(2 * I * 2 * pi_rad * 16.5e9 / light_mps * sphere_m),
                                  .vv = -0.5 * sphere_m * cexp(2 * I * 2 * pi_rad * 16.5e9 / light_mps * sphere_m)};
    *truth = (RadarTruth){.visible = 0.81, .snr = 5, .rcs_m2 = {0, 0, 0}};
    truth->rcs_m2[own] = 4 * pi_rad * pow(cabs(p->a[0][0][own][own]), 2);
    return shot_bounce(&c->shot, &c->target, &direct, truth);
}

/* Echoes in all four channels and all pulses, in the middle of the band, where a sample is the sum over echoes of a
 * exp(-j k (path + growth n)). Amplitude: lambda (P / L)^0.5 / (4 pi R_out R_back) gain gain S, half of all losses. */
static void echoes_are_those_of_images(void **state)
{
    (void)state;
    const double  k = 2 * pi_rad * 16.5e9 / light_mps;
    SnapshotChaff chaff = {.id = {1, 2, 3}, .age_s = 5};
    for (int h = 0; h < 2; h++) {
        Case       c;
        RadarTruth truth;
        double     worst = 0, most[interval_channels] = {0};
        arena_reset(stage.arena);
        set_up(&c, h);
        /* chaff in the middle of the direct path: N lambda^2 / (2 pi) over 2 pi r^2, of power, each way */
        const double chaff_v[3] = {0, 0, -1}, r_m = 1 + 7 * (1 - exp(-5)) + 0.3 * 5;
        double       middle[3];
        v3_add(middle, c.shot.p_enu, c.target.p_enu);
        v3_scale(middle, 0.5, middle);
        ecef_from_enu(chaff.p_ecef, &stage.world.frame, middle);
        m3_mul_v3(chaff.v_ecef_mps, stage.world.frame.r_ecef_from_enu, chaff_v);
        stage.snapshot.chaff = &chaff, stage.snapshot.chaff_count = 1;
        CHECK(shot_volume_open(&c.shot) == STATUS_OK);
        stage.snapshot.chaff_count = 0;
        const Paper  p = paper_of(&c);
        const int    own = h ? 0 : 1, other = 1 - own;
        const double lambda = 2 * pi_rad / k,
                     volume_np = 3e6 * lambda * lambda / (2 * pi_rad) / (2 * pi_rad * r_m * r_m);
        CHECK(bounce(&c, &truth, &p, own) == STATUS_OK && c.shot.missing == 0);
        memset(sample, 0, sizeof sample);
        echo_sum(sample, radar->echoes);

        double complex a[2][interval_channels] = {{0}};
        for (int twice = 0; twice < 2; twice++) {
            const double r1_m = twice ? p.i_m : p.d_m, np = 5e-4 * (r1_m + p.i_m) + 2 * volume_np;
            const double unit = 0.9 * lambda * sqrt(radar->preset.power_w / radar->preset.loss) /
                                (4 * pi_rad * r1_m * p.i_m) * exp(-0.5 * np);
            for (int round = 0; round < (twice ? 1 : 2); round++) {
                const bool    out = twice || round, back = twice || !round; /* by the ground */
                const double *go = out ? p.gain_i : p.gain_d, *gb = back ? p.gain_i : p.gain_d;
                for (int ch = 0; ch < 3; ch++) a[twice][ch] += unit * go[0] * gb[ch] * p.a[out][back][own][own];
                a[twice][CHANNEL_CROSS] += unit * go[0] * gb[0] * p.a[out][back][other][own];
            }
        }
        const double repeat_hz = radar->preset.wave.repeat_hz;
        const double path_m[2] = {p.d_m + p.i_m - 2 * 299, 2 * p.i_m - 2 * 299};
        const double growth_m[2] = {(p.d_mps + p.i_mps - 2 * 11) / repeat_hz, (2 * p.i_mps - 2 * 11) / repeat_hz};
        for (int ch = 0; ch < interval_channels; ch++) {
            double off = 0;
            for (int n = 0; n < 128; n++) {
                double complex want = 0;
                for (int twice = 0; twice < 2; twice++)
                    want += a[twice][ch] * cexp(-I * k * (path_m[twice] + (n - 63.5) * growth_m[twice]));
                most[ch] = fmax(most[ch], cabs(want));
                off = fmax(off, cabs(sample[((size_t)ch * 128 + (size_t)n) * 512 + 256] - want));
            }
            printf("%s channel %d: off by %.3f of %.3g; once %.3g, twice %.3g\n", h ? "h" : "v", ch, off / most[ch],
                   most[ch], cabs(a[0][ch]), cabs(a[1][ch]));
            worst = fmax(worst, off / most[ch]);
        }
        CHECK(worst < 0.04);
        /* truth: spread and extra path of the leg by the ground */
        const double complex e = p.d_m / p.i_m * cexp(-I * k * (p.i_m - p.d_m));
        static const int     axes[3][2] = {{0, 0}, {1, 1}, {0, 1}};
        for (int x = 0; x < 3; x++) {
            const int            r = axes[x][0], t = axes[x][1];
            const double complex once = e * (p.a[0][1][r][t] + p.a[1][0][r][t]), twice = e * e * p.a[1][1][r][t];
            const double complex all = p.a[0][0][r][t] + once + twice;
            const double         full = 2 * sqrt(pi_rad) * 0.04 * (cabs(once) + cabs(twice));
            CHECK_NEAR(sqrt(truth.bounce.once_m2[x]), 2 * sqrt(pi_rad) * cabs(once), full);
            CHECK_NEAR(sqrt(truth.bounce.twice_m2[x]), 2 * sqrt(pi_rad) * cabs(twice), full);
            CHECK_NEAR(sqrt(truth.bounce.rcs_m2[x]), 2 * sqrt(pi_rad) * cabs(all), 1.5 * full);
            printf("rcs %g: once %g of %g, twice %g of %g, all %g of %g m2\n", (double)x, truth.bounce.once_m2[x],
                   4 * pi_rad * pow(cabs(once), 2), truth.bounce.twice_m2[x], 4 * pi_rad * pow(cabs(twice), 2),
                   truth.bounce.rcs_m2[x], 4 * pi_rad * pow(cabs(all), 2));
        }
        CHECK_NEAR(truth.bounce.coherence, fmax(cabs(p.te), cabs(p.tm)), 1e-4);
        CHECK_NEAR(truth.snr / (5 * truth.bounce.rcs_m2[own] / truth.rcs_m2[own]), 1, 1e-12);
    }
}

/* Whether there are echoes by way of the ground. */
static bool mirrors(Case *c)
{
    RadarTruth  truth;
    const Paper p = paper_of(c);
    CHECK(bounce(c, &truth, &p, 0) == STATUS_OK);
    memset(sample, 0, sizeof sample);
    echo_sum(sample, radar->echoes);
    double most = 0;
    for (int n = 0; n < 128; n++) most = fmax(most, cabs(sample[(size_t)n * 512 + 256]));
    CHECK((most > 0) == (truth.bounce.coherence > 0) && (most > 0) == (truth.bounce.rcs_m2[0] > 0));
    CHECK(truth.snr == 5 || most > 0);
    return most > 0;
}

/* Each limit from either side: the extra path against the window, coherence 0.001, the antenna's reach, a settings
 * switch, coarse signatures, something before the reflection, a target below the ground. */
static void what_takes_them_away(void **state)
{
    (void)state;
    const double k = 2 * pi_rad * 16.5e9 / light_mps;
    Case         c;
    arena_reset(stage.arena);
    set_up(&c, true);
    const Paper p = paper_of(&c);
    CHECK(mirrors(&c));
    for (int i = 0; i < 2; i++) {
        const double by = i ? 1.01 : 0.99, window_m = c.shot.half_window_m;
        c.shot.half_window_m = (p.i_m - p.d_m) * by;
        CHECK(mirrors(&c) == (i == 1));
        c.shot.half_window_m = window_m;
        c.shot.widest = p.off * by;
        CHECK(mirrors(&c) == (i == 1));
        c.shot.widest = 0.1;
        /* the larger of the coefficients is that of te; without roughness it is te over that of 5 mm */
        const double smooth = cabs(p.te) / exp(-2 * pow(k * 5e-3 * p.sine, 2));
        for (int s = 0; s < SURFACE_COUNT; s++)
            radar->mirror.row[s].rms_m = sqrt(0.5 * log(smooth / (1e-3 * by))) / (k * p.sine);
        CHECK(mirrors(&c) == (i == 1));
        for (int s = 0; s < SURFACE_COUNT; s++) radar->mirror.row[s].rms_m = 5e-3;
    }
    radar->ground_bounce = false;
    CHECK(!mirrors(&c));
    radar->ground_bounce = true;
    c.shot.coarse = true;
    CHECK(!mirrors(&c));
    c.shot.coarse = false;
    CHECK(mirrors(&c));

    /* another sphere half way to the reflection hides it; one at its side by more than its radius does not */
    for (int beside = 0; beside < 2; beside++) {
        arena_reset(stage.arena);
        set_up(&c, true);
        double at[3];
        v3_add(at, c.shot.p_enu, c.p_ground);
        scene_add(0, 0.5 * at[0] + (beside ? 1.2 * sphere_m : 0), 0.5 * at[1], 0.5 * at[2]);
        CHECK(visibility_create(&c.visibility, stage.world.tracer, &land, &stage.world.frame, &stage.snapshot, 0,
                                stage.arena) == STATUS_OK);
        c.shot.visibility = c.visibility;
        CHECK(mirrors(&c) == (beside == 1));
    }

    arena_reset(stage.arena);
    set_up(&c, true);
    for (int below = 0; below < 2; below++) { /* by a little less, and more, than its radius */
        c.target.p_enu[2] = ground_at(3, away_m, NULL) - (below ? 1.1 : 0.9) * c.target.of->radius_m;
        radar_antenna(&c.target.antenna, c.shot.p_enu, c.target.p_enu, c.target.r_enu_from_body);
        RadarTruth  truth;
        const Paper lower = paper_of(&c);
        CHECK(bounce(&c, &truth, &lower, 0) == STATUS_OK);
        echo_sum(sample, radar->echoes);
        CHECK((truth.bounce.coherence > 0) == (below == 0));
    }
}

/* On hills the ground mirrors as a plane: that under an entity which is no more than two radii above it, else that at
 * the reflection, where the ground slopes otherwise. */
static void which_plane_mirrors(void **state)
{
    (void)state;
    Landscape       level = land;
    LandscapeConfig config = landscape_default_config();
    config.half_width_m = 500;
    config.horizon_m = 20000;
    config.relief_m = 60;
    CHECK(landscape_create(&land, &config, &stage.world.frame, NULL, 0, NULL, 0) == STATUS_OK);
    int seen = 0;
    for (int i = 0; i < 2; i++) {
        Case       c;
        RadarTruth truth;
        double     n[3], p[3] = {3, away_m, 0};
        arena_reset(stage.arena);
        set_up(&c, true);
        p[2] = ground_at(p[0], p[1], n);
        const double up_m = (i ? 2.1 : 1.9) * c.target.of->radius_m / n[2]; /* so far from the plane */
        c.target.p_enu[2] = p[2] + up_m;
        for (int k = 0; k < 2; k++) c.target.p_enu[k] = p[k];
        c.shot.p_enu[2] = stage.view.p_enu[2] = p[2] + 150; /* above all hills between */
        c.shot.widest = 1;
        radar_antenna(&c.target.antenna, c.shot.p_enu, c.target.p_enu, c.target.r_enu_from_body);
        memcpy(c.p_ground, p, sizeof p);
        memcpy(c.n, n, sizeof n);
        const Paper under = paper_of(&c);
        CHECK(bounce(&c, &truth, &under, 0) == STATUS_OK);
        echo_forget(radar->echoes);
        const double want = fmax(cabs(under.te), cabs(under.tm));
        printf("%s radii up: mirrors %.5f, the plane under it %.5f\n", i ? "2.1" : "1.9", truth.bounce.coherence, want);
        seen += truth.bounce.coherence > 0;
        if (i == 0) CHECK_NEAR(truth.bounce.coherence, want, 1e-9);
        else CHECK(fabs(truth.bounce.coherence - want) > 1e-5);
    }
    CHECK(seen == 2);
    landscape_destroy(&land);
    land = level;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(echoes_are_those_of_images),
        cmocka_unit_test(what_takes_them_away),
        cmocka_unit_test(which_plane_mirrors),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
