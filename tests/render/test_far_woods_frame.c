/* Far woods of a frame: what each node of the table shows of leaves, bark and ground under this sun and sky
 * (render/light/far_woods.h), of stands that are made by hand. labels: physics */
#include "tests/render/far_woods_stage.h"

/* ---- a node on paper -------------------------------------------------------------------------- */

static double mean(double low, double high, double share) { return (1 - share) * low + share * high; }

static CanopyPlace mean_place(const CanopyPlace *p, double share)
{
    return (CanopyPlace){mean(p[0].up, p[1].up, share),
                         mean(p[0].down, p[1].down, share),
                         mean(p[0].up_from_ground, p[1].up_from_ground, share),
                         mean(p[0].sun_here, p[1].sun_here, share),
                         mean(p[0].sun_on_ground, p[1].sun_on_ground, share),
                         .low = 1};
}

/* M of render/light/canopy.h, and what falls on the ground below. */
static double leaves_w_m2(double *below_w_m2, const CanopyPlace *p, double sun_w_m2, double sky_w_m2, double sin_sun,
                          double ground_rho)
{
    const double u = fmin(p->up, open_up), d = fmin(p->down, open_down), hidden = 1 - p->up_from_ground;
    const double through = sun_w_m2 * sin_sun * p->sun_on_ground + sky_w_m2 * p->up_from_ground;
    const double on_both =
        (sin_sun > 0 ? 0.5 * sun_w_m2 * fmin(p->sun_here, open_up) : 0) + u * sky_w_m2 + d * ground_rho * through;
    const double m = scattered / 2 * on_both / (1 - scattered / 2 * (2 - u - d + d * ground_rho * hidden));
    *below_w_m2 = through + hidden * m;
    return m;
}

static void azimuthal(double n[3], const double lean[2], double azimuth_rad)
{
    const double length = hypot(lean[0], lean[1]);
    n[0] = length > 0 ? lean[0] / length * cos(azimuth_rad) : 0;
    n[1] = length > 0 ? lean[0] / length * sin(azimuth_rad) : 0;
    n[2] = length > 0 ? lean[1] / length : 1;
}

/* Irradiance of a plane over what it faces of the sky. */
static double sky_on(AirBand band, const double n[3])
{
    return daylight_on_plane(&air.light, band, n) / (0.5 * (1 + n[2]));
}

/* Where the sun is among the nodes of sun_deg. */
typedef struct SunPlace {
    int    node;
    double share, sin_sun, azimuth_rad;
} SunPlace;

typedef struct OnPaper {
    double reflects[2][optical_channel_count], warmer_k[2], sun, radar;
} OnPaper;

/* Radiance times pi of leaves, bark and ground, each of what falls on its two sides: sky and ground by their shares,
 * leaves in the rest; and of direct sun. */
static void optical_on_paper(double out[2], const WoodStand *s, int v, const StandLit *lit, const SunPlace *sun,
                             const double n_leaf[3], const double n_bark[3], int c, const Material *ground)
{
    const StandView  *of = &s->view[v];
    const StandOrgan *l = &of->leaf, *b = &of->bark;
    const double      back[3] = {-n_leaf[0], -n_leaf[1], -n_leaf[2]};
    const double e_sun = air.light.sun_w_m2[c], e_sky = air.light.sky_w_m2[c], land = (double)materials.ground_rho[c];
    const CanopyPlace among = mean_place(&of->among[sun->node], sun->share),
                      below = mean_place(&of->on_ground[sun->node], sun->share);
    double       on_ground, on_floor;
    const double m = leaves_w_m2(&on_ground, &among, e_sun, e_sky, sun->sin_sun, land);
    const double m_floor = leaves_w_m2(&on_floor, &below, e_sun, e_sky, sun->sin_sun, land);
    const double e_ground = land * on_ground;
    const double front = l->front_up * sky_on((AirBand)c, n_leaf) + l->front_down * e_ground +
                         (l->bright - l->front_up - l->front_down) * m;
    const double behind =
        l->back_up * (n_leaf[2] == 1 ? (double)air.light.plane_w_m2[c][0][0] : sky_on((AirBand)c, back)) +
        l->back_down * e_ground + (l->bright - l->back_up - l->back_down) * m;
    const double bark = b->front_up * sky_on((AirBand)c, n_bark) + b->front_down * e_ground +
                        fmax(b->bright - b->front_up - b->front_down, 0) * m;
    const double floor = of->ground * (of->ground_up * e_sky + (1 - of->ground_up) * m_floor);
    out[0] = (double)s->leaf.rho[c] * front + (double)s->leaf.tau[c] * behind + (double)s->bark.rho[c] * bark +
             (double)ground->rho[c] * floor;
    out[1] = out[0] +
             e_sun * ((double)s->leaf.rho[c] * lit->leaf_front + (double)s->leaf.tau[c] * lit->leaf_back +
                      (double)s->bark.rho[c] * lit->bark_front + (double)ground->rho[c] * lit->ground * sun->sin_sun);
}

/* Temperature of level ground of the row's reflectance that has the radiance of all in 8-12 um: emitted by each at its
 * temperature, and what each reflects or lets through of sky and ground, as far as it faces them. */
static double temp_on_paper(const WoodStand *s, int v, double lit_leaves, const double n_leaf[3],
                            const double n_bark[3], const Material *ground, const Material *row, double bark_k,
                            double ground_k)
{
    const StandView  *of = &s->view[v];
    const StandOrgan *l = &of->leaf, *b = &of->bark;
    const double      back[3] = {-n_leaf[0], -n_leaf[1], -n_leaf[2]}, air_k = air.light.weather.air_temp_k;
    const double      rho = (double)s->leaf.rho_lwir, tau = (double)s->leaf.tau_lwir, wood = (double)s->bark.rho_lwir,
                 floor = (double)ground->rho_lwir, up = 0.5 * (1 + l->n[1]), bark_up = 0.5 * (1 + b->n[1]);
    const double shade_k = thermal_leaf_k(&air.light, &s->leaf, air_k, l->open, 0),
                 sun_k = thermal_leaf_k(&air.light, &s->leaf, air_k, l->open, 1);
    const double from_sky = sky_on(AIR_LWIR, n_leaf) / pi_rad, bark_sky = sky_on(AIR_LWIR, n_bark) / pi_rad,
                 through_sky =
                     (n_leaf[2] == 1 ? (double)air.light.plane_w_m2[AIR_LWIR][0][0] : sky_on(AIR_LWIR, back)) / pi_rad,
                 below = air.light.ground_w_m2_sr[AIR_LWIR], level = air.light.sky_w_m2[AIR_LWIR] / pi_rad;
    if (!(level > 0))
        return (l->share - lit_leaves) * shade_k + lit_leaves * sun_k + b->share * bark_k + of->ground * ground_k;
    double sum = (1 - rho - tau) * ((l->share - lit_leaves) * planck_table_radiance(lwir, shade_k) +
                                    lit_leaves * planck_table_radiance(lwir, sun_k));
    sum += l->share * (rho * (up * from_sky + (1 - up) * below) + tau * ((1 - up) * through_sky + up * below));
    sum += b->share *
           ((1 - wood) * planck_table_radiance(lwir, bark_k) + wood * (bark_up * bark_sky + (1 - bark_up) * below));
    sum += of->ground * ((1 - floor) * planck_table_radiance(lwir, ground_k) + floor * level);
    return planck_table_temp(lwir, (sum - (double)row->rho_lwir * level) / (1 - (double)row->rho_lwir));
}

typedef double BarkK(const WoodStand *s, int view, const double n_bark[3]);
typedef double GroundK(const WoodStand *s, int view, int surface);

static double bark_as_air(const WoodStand *s, int view, const double n_bark[3])
{
    (void)s, (void)view, (void)n_bark;
    return air.light.weather.air_temp_k;
}
static double ground_as_air(const WoodStand *s, int view, int surface)
{
    (void)s, (void)view, (void)surface;
    return air.light.weather.air_temp_k;
}

static OnPaper node_on_paper(int k, int p, int g, int v, int a, const SunPlace *sun, BarkK *bark_k, GroundK *ground_k)
{
    const WoodStand *s = &stand[k][p];
    const StandLit  *low = &s->lit[v][sun->node][a], *high = &s->lit[v][sun->node + 1][a];
    const Material  *ground = &rows[g ? row_scrub : row_ground], *row = &rows[row_canopy + k];
    const int        surface = g ? SURFACE_SCRUB : k ? SURFACE_FOREST_CONIFER : SURFACE_FOREST_BROADLEAF;
    /* glades are shaded by thickets: exp(-0.015 cot h) (far_woods.c, found beside planted woods) */
    const double   past = sun->sin_sun > 0 ? exp(-0.015 / tan(asin(sun->sin_sun))) : 1;
    const StandLit lit = {
        past * mean(low->leaf, high->leaf, sun->share), past * mean(low->leaf_front, high->leaf_front, sun->share),
        past * mean(low->leaf_back, high->leaf_back, sun->share),
        past * mean(low->bark_front, high->bark_front, sun->share), past * mean(low->ground, high->ground, sun->share)};
    const double eye_rad = sun->azimuth_rad + azimuth_deg[a] * rad_per_deg;
    OnPaper      out = {0};
    double       n_leaf[3], n_bark[3];
    azimuthal(n_leaf, s->view[v].leaf.n, eye_rad), azimuthal(n_bark, s->view[v].bark.n, eye_rad);
    out.radar = s->view[v].leaf.share * (double)s->leaf.radar_gamma +
                s->view[v].bark.share * (double)s->bark.radar_gamma + s->view[v].ground * (double)ground->radar_gamma;
    if (sun->sin_sun > 0)
        out.sun = ((double)s->leaf.rho_mwir * lit.leaf_front + (double)s->leaf.tau_mwir * lit.leaf_back +
                   (double)s->bark.rho_mwir * lit.bark_front + (double)ground->rho_mwir * lit.ground * sun->sin_sun) /
                  ((double)row->rho_mwir * fmax(sun->sin_sun, 0.01));
    for (int c = 0; c < optical_channel_count; c++) {
        double seen[2];
        optical_on_paper(seen, s, v, &lit, sun, n_leaf, n_bark, c, ground);
        const double sky = air.light.sky_w_m2[c], direct = air.light.sun_w_m2[c] * sun->sin_sun * out.sun;
        out.reflects[0][c] = seen[0] / ((double)row->rho[c] * sky);
        out.reflects[1][c] = seen[1] / ((double)row->rho[c] * (sky + direct));
    }
    for (int lit_by_sun = 0; lit_by_sun < 2; lit_by_sun++)
        out.warmer_k[lit_by_sun] = temp_on_paper(s, v, lit_by_sun && sun->sin_sun > 0 ? lit.leaf : 0, n_leaf, n_bark,
                                                 ground, row, bark_k(s, v, n_bark), ground_k(s, v, surface)) -
                                   air.light.weather.air_temp_k;
    return out;
}

static void nodes_are_as_on_paper(const SunPlace *sun, BarkK *bark_k, GroundK *ground_k, double within_k)
{
    FarWoodsFrame *frame = NULL;
    assert_int_equal(far_woods_frame(&frame, &far, &air, &materials, arena), STATUS_OK);
    CHECK(frame->far == &far);
    CHECK_NEAR(remainder(frame->sun_azimuth_rad - sun->azimuth_rad, 2 * pi_rad), 0, 1e-12);
    for (int c = 0; c < optical_channel_count; c++) {
        CHECK_NEAR(frame->sun_w_m2[c], (500 + 20 * c) * sun->sin_sun, 1e-9);
        CHECK_NEAR(frame->sky_w_m2[c], pi_rad * (20 + 3 * c), 1e-9);
    }
    for (int n = 0; n < far_stands * far_densities * far_grounds * stand_views * stand_azimuths; n++) {
        const int a = n % stand_azimuths, v = n / stand_azimuths % stand_views, i = n / stand_azimuths / stand_views;
        const int k = i / 4, p = i / 2 % 2, g = i % 2;
        const OnPaper  want = node_on_paper(k, p, g, v, a, sun, bark_k, ground_k);
        const FarNode *got = &frame->node[k][p][g][v][a];
        CHECK_NEAR(got->sun, want.sun, 1e-5 * want.sun);
        CHECK_NEAR(got->radar, want.radar, 1e-6);
        for (int lit = 0; lit < 2; lit++) {
            for (int c = 0; c < optical_channel_count; c++)
                CHECK_NEAR(got->reflects[lit][c], want.reflects[lit][c], 1e-5 * want.reflects[lit][c]);
            CHECK_NEAR(got->warmer_k[lit], want.warmer_k[lit], within_k);
        }
    }
    arena_reset(arena);
}

/* The sun halfway between two heights of the table, at a node, low, and below the horizon; with thermal bands and
 * without. */
static void light_of_nodes(void **state)
{
    (void)state;
    static const struct {
        double elevation_deg, azimuth_deg;
        int    node;
        double share;
    } sun[] = {{28, 70, 2, 0.5}, {36, -130, 3, 0}, {75, 200, 4, 0.5}, {0.4, 10, 0, 0}, {-5, 10, 0, 0}, {10, 0, 1, 0}};
    for (size_t k = 0; k < sizeof sun / sizeof *sun; k++) {
        const SunPlace at = {sun[k].node, sun[k].share, fmax(sin(sun[k].elevation_deg * rad_per_deg), 0),
                             sun[k].azimuth_deg * rad_per_deg};
        CHECK(sun_deg[at.node] * (1 - at.share) + sun_deg[at.node + 1] * at.share ==
              fmax(sun[k].elevation_deg, sun_deg[0]));
        for (int thermal = 0; thermal < 2; thermal++) {
            set_air(sun[k].elevation_deg, sun[k].azimuth_deg, thermal);
            nodes_are_as_on_paper(&at, bark_as_air, ground_as_air, 2e-3);
        }
    }
    FarWoodsFrame *none = (FarWoodsFrame *)&far;
    assert_int_equal(far_woods_frame(&none, NULL, &air, &materials, arena), STATUS_OK);
    CHECK(none == NULL);
}

/* ---- heat ------------------------------------------------------------------------------------- */

static HeatNow   now;
static HeatScene heat = {.now = &now};

/* Bark of 290 K, 8 K warmer towards the south-west and 3 K above; of other radii and other wood colder. Ground of
 * every class at its own temperature in the sun, 12 K colder in the shade and 4 K warmer beneath a hidden sky. */
static const double bark_mean_k = 290, bark_side_k = 8, bark_up_k = 3, bark_side_rad = 225 * rad_per_deg;
static const double shade_colder_k = 12, hidden_warmer_k = 4;

static double sunlit_k(int kind) { return 300 + kind; }

static void set_heat(void)
{
    memset(&now, 0, sizeof now);
    now.table.facets = 3;
    for (int kind = 0; kind < ground_kinds; kind++) {
        for (int n = 0; n < heat_most_facets * heat_most_facets; n++) now.table.sun_k[kind][n] = (float)sunlit_k(kind);
        for (int n = 0; n < heat_ups; n++) now.table.shade_k[kind][n] = (float)(sunlit_k(kind) - shade_colder_k);
        for (int n = 0; n < heat_ups; n++) now.table.dark_k[kind][n] = now.table.shade_k[kind][n];
        now.table.hidden_k[kind] = (float)(sunlit_k(kind) - shade_colder_k + hidden_warmer_k);
        for (int n = 0; n < heat_day_slots; n++) now.table.slot_k[kind][n] = 1;
    }
    for (int k = 0; k < SURFACE_COUNT; k++) now.kind_of[k] = k;
    now.branches = 2, now.branch_material[0] = row_leaf, now.branch_material[1] = row_bark;
    for (int r = 0; r < branch_radii; r++)
        for (int lit = 0; lit < 2; lit++) {
            now.table.branch[0][r][lit].mean_k = 250;
            now.table.branch[1][r][lit] =
                (BranchSides){.mean_k = r == 1 ? (float)bark_mean_k : 260,
                              .side_k = {(float)(bark_side_k * cos(bark_side_rad)),
                                         (float)(bark_side_k * sin(bark_side_rad)), (float)bark_up_k}};
        }
}

/* Sides at -65, -35, 0, 35, 65 degrees from the eye's azimuth count by their cosines c, so a part of the temperature
 * that goes as the cosine of the azimuth is weighted by sum c^2 / sum c = 2.699229 / 3.483543 = 0.774852. Branches
 * whose sides rise by n - 0.6, n, n + 0.6, within +-0.95, count by l = sqrt(1 - up^2): sum l^2 / sum l, and sum l up /
 * sum l. */
static double bark_by_sides(const WoodStand *s, int view, const double n_bark[3])
{
    double l1 = 0, l2 = 0, rise = 0;
    for (int k = -1; k <= 1; k++) {
        const double up = fmax(fmin(s->view[view].bark.n[1] + 0.6 * k, 0.95), -0.95), level = sqrt(1 - up * up);
        l1 += level, l2 += level * level, rise += level * up;
    }
    return bark_mean_k + bark_side_k * cos(atan2(n_bark[1], n_bark[0]) - bark_side_rad) * 0.774852 * l2 / l1 +
           bark_up_k * rise / l1;
}

static double sunlit_ground(const WoodStand *s, int view, int surface)
{
    (void)s, (void)view;
    return sunlit_k(surface);
}

/* Every past sun stood at 28 degrees, halfway between two heights of the table; what does not come through is shade. */
static double shaded_ground(const WoodStand *s, int view, int surface)
{
    const StandView *of = &s->view[view];
    const double     taken = 1 - 0.5 * (of->ground_through[2] + of->ground_through[3]);
    return sunlit_k(surface) - taken * shade_colder_k + (1 - of->ground_open) * hidden_warmer_k;
}

static void temperatures_of_nodes(void **state)
{
    (void)state;
    const SunPlace at = {2, 0.5, sin(28 * rad_per_deg), 70 * rad_per_deg};
    for (int shaded = 0; shaded < 2; shaded++) {
        set_air(28, 70, true);
        set_heat();
        air.heat = &heat, heat.shadow = shaded ? (const ShadowMap *)&now : NULL; /* only that there is one is asked */
        now.slots = 8;
        for (int k = 0; k < now.slots; k++)
            now.slot_d_enu[0][k] = (float)cos(28 * rad_per_deg), now.slot_d_enu[2][k] = (float)sin(28 * rad_per_deg);
        /* a shadow is kept in 255 steps, of 12 K */
        nodes_are_as_on_paper(&at, bark_by_sides, shaded ? shaded_ground : sunlit_ground, shaded ? 0.03 : 3e-3);
        now.branches = 0;
        nodes_are_as_on_paper(&at, bark_as_air, shaded ? shaded_ground : sunlit_ground, shaded ? 0.03 : 3e-3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_of_nodes),
        cmocka_unit_test(temperatures_of_nodes),
    };
    return cmocka_run_group_tests(tests, open_stands, close_stands);
}
