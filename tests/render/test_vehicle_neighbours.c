/* tests/render/test_vehicle_neighbours.c: entities that stand by each other: shares of view as published view
 * factors and many rays of this file give them, heat that goes from one to the other, shadow, exhaust, and what must
 * change no bit. labels: physics */
#include "tests/render/hand_models.h"
#include "tests/render/vehicle_stage.h"

#include "render/heat/surface_flux_private.h"
#include "render/heat/vehicle_state_private.h"

static PlaceHeat weather; /* at all times and places */

static Status everywhere(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    (void)user, (void)p_enu, (void)present, (void)unix_s;
    *out = weather;
    return STATUS_OK;
}

/* All around, air too, at one temperature; no sun. */
static void enclose(double temp_k)
{
    weather = (PlaceHeat){.air_k = temp_k,
                          .air_density = 1,
                          .longwave_w_m2 = stefan_w_m2k4 * pow(temp_k, 4),
                          .ground_k = temp_k,
                          .under_k = temp_k,
                          .sun_d_enu = {0, 0, 1}};
}

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0}, truck = {1, 1, 222, 2, 6, 0, 0},
                           building = {5, 0, 0, 0, 0, 0, 0}, missile = {2, 2, 225, 1, 0, 0, 0};

/* ---- several ------------------------------------------------------------------------------ */

enum { crowd_most = 24 };

typedef struct Crowd {
    Snapshot       snapshot;
    SnapshotEntity entity[crowd_most];
    SnapshotJoints joints[crowd_most];
} Crowd;

/* The next one, its nose at a bearing from north, at a place. Returns its index; ids ascend, or as given. */
static int stand(Crowd *c, DisEntityType type, double east_m, double north_m, double bearing, EntityDrives drives)
{
    const double p_enu[3] = {east_m, north_m, 0}, s = sin(bearing), o = cos(bearing);
    const double r_enu_from_body[9] = {s, o, 0, o, -s, 0, 0, 0, -1};
    Scene        one;
    const int    at = c->snapshot.count++;
    place(&one, type, drives);
    c->entity[at] = one.entity;
    c->entity[at].id.entity = (uint16_t)(at + 1);
    c->joints[at] = one.joints;
    ecef_from_enu(c->entity[at].p_ecef, &stage.frame, p_enu);
    m3_mul(c->entity[at].r_ecef_from_body, stage.frame.r_ecef_from_enu, r_enu_from_body);
    c->snapshot.entity = c->entity, c->snapshot.joints = c->joints;
    return at;
}

static const KeptHeat *last_run; /* NULL: none */

static VehicleHeat *start(void)
{
    const VehicleHeatConfig config = {.step_s = 30, .window_us = INFINITY, .place = everywhere, .capacity = crowd_most};
    return stage_start(&config, last_run);
}

/* Ticks each second. */
static void run(VehicleHeat *heat, Crowd *c, double from_s, double to_s)
{
    for (double t_s = from_s; t_s <= to_s; t_s += 1) {
        c->snapshot.t_s = t_s;
        CHECK(vehicle_heat_tick(heat, &c->snapshot) == STATUS_OK);
    }
    CHECK(vehicle_heat_counters(heat)->failed == 0);
    CHECK(vehicle_heat_show(heat, &c->snapshot, stage.arena) == STATUS_OK);
}

/* What comes next begins at one temperature all through: as kept from a run that ended just before. */
static void begin_at(KeptHeat **kept, DisEntityId id, DisEntityType type, double temp_k)
{
    Crowd         c = {0};
    char          path[text_file_size];
    VehicleNodes  n;
    static double node_k[1024];
    last_run = NULL;
    VehicleHeat *heat = start();
    stand(&c, type, 0, 0, 0, (EntityDrives){0});
    CHECK(vehicle_heat_tick(heat, &c.snapshot) == STATUS_OK && vehicle_heat_nodes(&n, heat, c.entity[0].id));
    CHECK(n.shape->nodes <= 1024);
    for (int k = 0; k < n.shape->nodes; k++) node_k[k] = temp_k;
    text_file(path, "");
    const KeptNodes nodes = {id, tracer_model(stage.tracer, c.entity[0].model)->name, 0, n.shape->nodes, node_k};
    CHECK(heat_kept_save(&nodes, 1, path) == STATUS_OK && heat_kept_open(kept, path) == STATUS_OK);
    remove(path);
    vehicle_heat_destroy(heat);
    last_run = *kept;
}

static void forget(KeptHeat *kept)
{
    last_run = NULL;
    heat_kept_close(kept);
}

/* Of the patches of an entity that face within 60 degrees of a way (body axes), by area. */
static double side_k(const Crowd *c, int at, const double way[3])
{
    const SnapshotEntity *e = &c->entity[at];
    const Patches        *p = &stage.patches.of[e->model];
    double                sum = 0, m2 = 0;
    for (int i = 0; i < p->count; i++) {
        const Patch *q = &p->patch[i];
        if (!(q->facing * v3_dot(q->n_node, way) > 0.5 && v3_dot(q->p_node, way) > 0)) continue;
        sum += patch_open_m2(q) * (double)c->snapshot.patch_k[e->first_patch + i], m2 += patch_open_m2(q);
    }
    return sum / m2;
}

static double worst_of(const Crowd *a, int i, const Crowd *b, int j)
{
    double worst_k = 0;
    CHECK(a->entity[i].patches == b->entity[j].patches && a->entity[i].patches > 0);
    for (int k = 0; k < a->entity[i].patches; k++)
        worst_k = fmax(worst_k, fabs((double)a->snapshot.patch_k[a->entity[i].first_patch + k] -
                                     (double)b->snapshot.patch_k[b->entity[j].first_patch + k]));
    return worst_k;
}

/* ---- views -------------------------------------------------------------------------------- */

/* Two equal parallel rectangles opposite each other, sides over their distance x and y: Incropera & DeWitt, table
 * 13.2; Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-11. */
static double facing_rectangles(double x, double y)
{
    const double x1 = sqrt(1 + x * x), y1 = sqrt(1 + y * y);
    return 2 / (pi_rad * x * y) *
           (log(x1 * y1 / sqrt(1 + x * x + y * y)) + x * y1 * atan(x / y1) + y * x1 * atan(y / x1) - x * atan(x) -
            y * atan(y));
}

static void plates_see_each_other_as_published(void **state)
{
    (void)state;
    static const double side_m[] = {1, 1, 3, 3, 6}, away_m[] = {1, 0.5, 3, 1, 3};
    CHECK_NEAR(facing_rectangles(1, 1), 0.19982, 5e-6); /* opposite sides of a cube */
    for (size_t c = 0; c < sizeof side_m / sizeof *side_m; c++) {
        Model        model;
        Tracer      *tracer;
        Patches      patches;
        PosedNode    node[2][4];
        PosedEntity  posed[2] = {{.node = node[0]}, {.node = node[1]}};
        NodePose     pose = {.r_body_from_node = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
        PatchPose    at[2];
        const double r[2][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {-1, 0, 0, 0, -1, 0, 0, 0, 1}};
        const double p[2][3] = {{0, 0, 0}, {away_m[c], 0, 0}};
        const double want = facing_rectangles(side_m[c] / away_m[c], side_m[c] / away_m[c]);
        double       share = 0, miss2 = 0, m2 = 0;
        hand_plate(&model, 0.5 * side_m[c], 0.5 * side_m[c]);
        const Model *models[1] = {&model};
        CHECK(tracer_create_models(&tracer, models, 1, "avx2") == STATUS_OK &&
              patches_create(&patches, &model) == STATUS_OK);
        for (int k = 0; k < 2; k++) {
            parts_pose(&posed[k], tracer, 0, &pose, p[k], r[k], 0);
            at[k] =
                (PatchPose){.patches = &patches, .model = &model, .posed = &posed[k], .node = &pose, .above_m = 100};
            memcpy(at[k].r_enu_from_body, r[k], sizeof r[k]);
        }
        const PatchPose *other[2] = {NULL, &at[1]}; /* one is gone */
        for (int i = 0; i < patches.count; i++) {
            NearView view;
            vehicle_view_near(&view, &at[0], i, other, 2);
            const int all = view.sky + view.ground + view.under + view.own;
            CHECK(view.own == 0 && view.under == 0);
            for (int k = 0; k < view.partners; k++) CHECK(view.slot[k] == 1 && view.patch[k] < patches.count);
            share += patches.patch[i].area_m2 * all / (patch_points * patch_near_rays), m2 += patches.patch[i].area_m2;
            miss2 += 0.05 * 0.05 * patches.patch[i].area_m2 * patches.patch[i].area_m2;
        }
        print_message("plates of %g m, %g m apart, %d patches: %.4f, published %.4f\n", side_m[c], away_m[c],
                      patches.count, share / m2, want);
        CHECK_NEAR(share / m2, want, 2 * sqrt(miss2) / m2); /* 0.05 of a share a patch, twice */
        patches_destroy(&patches);
        tracer_destroy(tracer);
        hand_free(&model);
    }
}

/* Towards a direction k of many about a normal, by the cosine; not those of heat_patches.c. */
static void cosine_way(double d[3], const double n[3], int k, int many)
{
    double u[3], v[3], axis[3] = {0, 0, 0};
    axis[fabs(n[0]) < 0.6 ? 0 : 1] = 1;
    v3_cross(u, n, axis);
    v3_normalize(u, u);
    v3_cross(v, n, u);
    const double sine = sqrt((k + 0.5) / many),
                 turn = 2 * pi_rad * (k * 0.7548776662466927 - floor(k * 0.7548776662466927));
    for (int i = 0; i < 3; i++) d[i] = sqrt(1 - sine * sine) * n[i] + sine * (cos(turn) * u[i] + sin(turn) * v[i]);
}

/* A posed entity of a crowd, seen from the first one's origin. */
typedef struct Posed {
    PosedEntity posed;
    PatchPose   pose;
    NodePose    node[64];
    double      joint[64];
    PosedNode   posed_node[64];
} Posed;

static void pose(Posed *out, const Crowd *c, int at)
{
    const SnapshotEntity *e = &c->entity[at];
    const Model          *model = tracer_model(stage.tracer, e->model);
    double                p_enu[3];
    CHECK(model->node_count <= 64 && parts_node_count(stage.tracer, e->model) <= 64);
    enu_from_ecef(p_enu, &stage.frame, e->p_ecef);
    out->posed = (PosedEntity){.node = out->posed_node};
    out->pose =
        (PatchPose){.patches = &stage.patches.of[e->model], .model = model, .posed = &out->posed, .node = out->node};
    m3_tmul(out->pose.r_enu_from_body, stage.frame.r_ecef_from_enu, e->r_ecef_from_body);
    snapshot_pose(out->node, out->joint, &c->snapshot, at, model);
    parts_pose(&out->posed, stage.tracer, e->model, out->node, p_enu, out->pose.r_enu_from_body, 0);
}

/* Share of a patch's hemisphere that the other takes, by 4 x 1000 rays. */
static double taken(const Posed *own, const Posed *other, int patch)
{
    enum { many = 1000 };
    const Patch *p = &own->pose.patches->patch[patch];
    int          met = 0;
    for (int point = 0; point < patch_points; point++) {
        const NodePose *n = &own->node[p->node];
        double          body[3], o[3], normal[3];
        m3_mul_v3(body, n->r_body_from_node, p->point_node[point]);
        v3_add(body, body, n->p_body);
        m3_mul_v3(o, own->pose.r_enu_from_body, body);
        m3_mul_v3(body, n->r_body_from_node, p->point_n_node[point]);
        m3_mul_v3(normal, own->pose.r_enu_from_body, body);
        v3_add(o, o, own->posed.p_enu);
        v3_add_scaled(o, o, 2e-3, normal);
        for (int k = 0; k < many; k++) {
            double  d[3];
            PartHit hit;
            cosine_way(d, normal, k, many);
            const double far_m = parts_first_hit(&hit, &other->posed, o, d, INFINITY, false);
            if (!(far_m < INFINITY) || parts_first_hit(&hit, &own->posed, o, d, far_m, false) < far_m) continue;
            met++;
        }
    }
    return (double)met / (patch_points * many);
}

/* ---- heat --------------------------------------------------------------------------------- */

/* Mean fourth power of the temperature of what faces within 60 degrees of a way, by area. */
static double facing_k4(const Crowd *c, int at, const double way_enu[3])
{
    static Posed posed;
    double       sum = 0, m2 = 0;
    pose(&posed, c, at);
    for (int i = 0; i < posed.pose.patches->count; i++) {
        double       n_enu[3];
        const double area_m2 = patch_open_m2(&posed.pose.patches->patch[i]);
        vehicle_view_normal(n_enu, &posed.pose, i);
        if (!(v3_dot(n_enu, way_enu) > 0.5)) continue;
        sum += area_m2 * pow((double)c->snapshot.patch_k[c->entity[at].first_patch + i], 4), m2 += area_m2;
    }
    return sum / m2;
}

/* A truck beside a wreck of 500 K takes what its view factors, by rays of this file, and sigma T^4 give. */
static void a_hot_wreck_warms_as_its_view_factor_says(void **state)
{
    (void)state;
    static const double wreck_k = 500, air_k = 288, away_m[] = {4, 8, 16}, west[3] = {-1, 0, 0};
    KeptHeat           *kept;
    enclose(air_k);
    begin_at(&kept, (DisEntityId){1, 1, 2}, tank, wreck_k);
    for (size_t k = 0; k < sizeof away_m / sizeof *away_m; k++) {
        static Posed posed[2];
        Crowd        c = {0};
        VehicleNodes before, after;
        VehicleHeat *heat = start();
        stand(&c, truck, 0, 0, 0, (EntityDrives){0});
        stand(&c, tank, away_m[k], 0, 0.3, (EntityDrives){0});
        run(heat, &c, 0, 1);
        CHECK(vehicle_heat_nodes(&before, heat, c.entity[0].id));
        const double from_j = before.heat_in_j, from_s = before.t_s, began_k4 = facing_k4(&c, 1, west);
        run(heat, &c, 2, 3);
        CHECK(vehicle_heat_nodes(&after, heat, c.entity[0].id));
        CHECK(after.t_s == 3 && from_s == 1);
        pose(&posed[0], &c, 0), pose(&posed[1], &c, 1);
        const double wreck_k4 = 0.5 * (began_k4 + facing_k4(&c, 1, west)); /* thin sheet cools meanwhile */
        double       want_w = 0;
        CHECK(wreck_k4 > pow(0.99 * wreck_k, 4) && wreck_k4 < pow(wreck_k, 4));
        for (int i = 0; i < posed[0].pose.patches->count; i++)
            want_w += after.shape->skin[i].emissivity * patch_open_m2(&posed[0].pose.patches->patch[i]) *
                      taken(&posed[0], &posed[1], i) * stefan_w_m2k4 * (wreck_k4 - pow(air_k, 4));
        const double got_w = (after.heat_in_j - from_j) / (after.t_s - from_s);
        print_message("wreck of 500 K %g m away: %.1f kW, by many rays %.1f kW\n", away_m[k], 1e-3 * got_w,
                      1e-3 * want_w);
        /* 96 rays a patch: some 400, 100, 40 of all meet it, evenly spread at 4 m; else two of their standard errors */
        CHECK_NEAR(got_w / want_w, 1, ((double[]){0.06, 0.2, 0.32})[k]);
        vehicle_heat_destroy(heat);
    }
    forget(kept);
}

/* Heat that a truck by a house takes, W, in the seconds after its past, in which the house sent it nothing. */
static double taken_w(void)
{
    Crowd        c = {0};
    VehicleNodes n;
    VehicleHeat *heat = start();
    stand(&c, truck, 0, 0, 0, (EntityDrives){0});
    stand(&c, building, 8, 0, 0, (EntityDrives){0});
    run(heat, &c, 0, 1);
    CHECK(vehicle_heat_nodes(&n, heat, c.entity[0].id));
    const double from_j = n.heat_in_j;
    run(heat, &c, 2, 3);
    CHECK(vehicle_heat_nodes(&n, heat, c.entity[0].id) && n.t_s == 3);
    const double w = 0.5 * (n.heat_in_j - from_j);
    vehicle_heat_destroy(heat);
    return w;
}

/* A house as warm as the air sends a truck what its wall reflects of the sky's light. */
static void a_wall_sends_light(void **state)
{
    (void)state;
    static const double sky_w_m2 = 500;
    static Posed        own, house;
    Crowd               c = {0}, alone = {0};
    KeptHeat           *kept;
    enclose(288);
    begin_at(&kept, (DisEntityId){1, 1, 2}, building, 288);
    const double dark_w = taken_w();
    weather.diffuse_w_m2 = sky_w_m2;
    const double light_w = taken_w();
    forget(kept);
    stand(&c, truck, 0, 0, 0, (EntityDrives){0});
    stand(&c, building, 8, 0, 0, (EntityDrives){0});
    stand(&alone, building, 0, 0, 0, (EntityDrives){0});
    pose(&own, &c, 0), pose(&house, &alone, 0);
    VehicleHeat *heat = start();
    VehicleNodes of[2];
    run(heat, &c, 0, 0);
    for (int k = 0; k < 2; k++) CHECK(vehicle_heat_nodes(&of[k], heat, c.entity[k].id));
    double sent_w_m2 = 0, m2 = 0, want_w = 0;
    for (int i = 0; i < house.pose.patches->count; i++) { /* the wall that faces it */
        double    n_enu[3];
        PatchView view;
        vehicle_view_normal(n_enu, &house.pose, i);
        if (!(house.pose.patches->patch[i].facing > 0.5 && n_enu[0] < -0.8)) continue;
        vehicle_view_look(&view, &house.pose, i);
        const double rho = 1 - of[1].shape->skin[i].absorptance;
        sent_w_m2 += patch_open_m2(&house.pose.patches->patch[i]) * rho * sky_w_m2 * (double)view.sky;
        m2 += patch_open_m2(&house.pose.patches->patch[i]);
    }
    sent_w_m2 /= m2;
    pose(&house, &c, 1);
    for (int i = 0; i < own.pose.patches->count; i++) {
        const double m2_taking = patch_open_m2(&own.pose.patches->patch[i]) * of[0].shape->skin[i].absorptance;
        want_w += m2_taking * taken(&own, &house, i) * sent_w_m2;
    }
    vehicle_heat_destroy(heat);
    print_message("light from a wall: %.0f W (in the dark %.2f W), by its mean and many rays %.0f W\n", light_w, dark_w,
                  want_w);
    CHECK_NEAR(dark_w, 0, 1);
    CHECK_NEAR(light_w / want_w, 1, 0.25); /* windows and bricks are not seen alike, nor its foot and its eaves */
}

/* Of two that see each other, areas times shares are the same both ways: what one loses to the other, that one
 * gains. */
static void what_one_loses_the_other_gains(void **state)
{
    (void)state;
    static const DisEntityType other[] = {{1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 2, 6, 0, 0}, {5, 0, 0, 0, 0, 0, 0}};
    static const double        away_m[] = {5, 4, 12};
    for (int k = 0; k < 3; k++) {
        static Posed posed[2];
        Crowd        c = {0};
        VehicleHeat *heat = start();
        double       m2[2] = {0};
        enclose(288);
        stand(&c, tank, 0, 0, 0, (EntityDrives){0});
        stand(&c, other[k], away_m[k], 1, 0.2, (EntityDrives){0});
        run(heat, &c, 0, 0); /* models are known */
        pose(&posed[0], &c, 0), pose(&posed[1], &c, 1);
        for (int side = 0; side < 2; side++) {
            /* seen from its own origin */
            Crowd        from = c;
            double       p_enu[3];
            static Posed own, its;
            for (int e = 0; e < 2; e++) {
                v3_sub(p_enu, posed[e].posed.p_enu, posed[side].posed.p_enu);
                ecef_from_enu(from.entity[e].p_ecef, &stage.frame, p_enu);
            }
            pose(&own, &from, side), pose(&its, &from, !side);
            own.pose.above_m = 0;
            const PatchPose *near[1] = {&its.pose};
            for (int i = 0; i < own.pose.patches->count; i++) {
                NearView view;
                vehicle_view_near(&view, &own.pose, i, near, 1);
                const int all = view.sky + view.ground + view.under + view.own;
                m2[side] += patch_open_m2(&own.pose.patches->patch[i]) * all / (patch_points * patch_near_rays);
            }
        }
        print_message("area times share: %.2f there, %.2f m2 back\n", m2[0], m2[1]);
        CHECK(m2[0] > 1);
        CHECK_NEAR(m2[1] / m2[0], 1, 0.2); /* four points stand for a patch: they lie inwards of its edges */
        vehicle_heat_destroy(heat);
    }
}

/* Tank, truck and house, as warm as all about them, stay so. */
static void an_enclosure_of_several_stays_as_it_is(void **state)
{
    (void)state;
    for (double temp_k = 240; temp_k < 330; temp_k += 60) {
        Crowd        c = {0};
        VehicleHeat *heat = start();
        double       worst_k = 0;
        enclose(temp_k);
        stand(&c, tank, 0, 0, 0, (EntityDrives){0});
        stand(&c, truck, 4, 0, 0.5, (EntityDrives){0});
        stand(&c, building, 14, 0, 0, (EntityDrives){0});
        run(heat, &c, 0, 300);
        for (int i = 0; i < c.snapshot.patch_count; i++)
            worst_k = fmax(worst_k, fabs((double)c.snapshot.patch_k[i] - temp_k));
        print_message("three in an enclosure of %g K: %.1e K\n", temp_k, worst_k);
        CHECK(c.snapshot.patch_count > 100 && worst_k < 1e-3);
        vehicle_heat_destroy(heat);
    }
}

/* The sun is low in the east, behind a house: a tank is as warm as one without a sun; when the house goes, its side
 * warms. */
static void shade_is_as_no_sun(void **state)
{
    (void)state;
    static const double right[3] = {0, 1, 0},
                        ways[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    Crowd        crowd[3]; /* shaded, without sun, in the sun */
    VehicleHeat *heat[3];
    for (int k = 0; k < 3; k++) {
        crowd[k] = (Crowd){0};
        enclose(285);
        weather.sun_d_enu[0] = cos(0.15), weather.sun_d_enu[2] = sin(0.15);
        weather.direct_w_m2 = k == 1 ? 0 : 700, weather.diffuse_w_m2 = 80;
        heat[k] = start();
        stand(&crowd[k], tank, 0, 0, 0, (EntityDrives){0});
        if (k < 2)
            stand(&crowd[k], building, 12, 1.3, 0.5 * pi_rad, (EntityDrives){0}); /* wider than the tank is long */
        run(heat[k], &crowd[k], 0, 120);
    }
    double worst_k = 0;
    for (int w = 0; w < 6; w++)
        worst_k = fmax(worst_k, fabs(side_k(&crowd[0], 0, ways[w]) - side_k(&crowd[1], 0, ways[w])));
    print_message("in a house's shadow: east side %.2f, without sun %.2f, in the sun %.2f K; sides differ by %.1e K\n",
                  side_k(&crowd[0], 0, right), side_k(&crowd[1], 0, right), side_k(&crowd[2], 0, right), worst_k);
    CHECK(side_k(&crowd[2], 0, right) > side_k(&crowd[1], 0, right) + 8);
    CHECK(worst_k < 0.05); /* the house's wall, 0.6 K warmer by the sun behind it, gives its east side 0.02 K; other
                              sides 0.003 K */
    const double shaded_k = side_k(&crowd[0], 0, right);
    const size_t near_bytes = vehicle_heat_bytes(heat[0]);
    crowd[0].snapshot.count = 1;
    weather.direct_w_m2 = 700;
    run(heat[0], &crowd[0], 121, 300);
    print_message("three minutes after the house went: %.2f K\n", side_k(&crowd[0], 0, right));
    CHECK(side_k(&crowd[0], 0, right) > shaded_k + 2);
    CHECK(vehicle_heat_bytes(heat[0]) < near_bytes);
    for (int k = 0; k < 3; k++) vehicle_heat_destroy(heat[k]);
}

/* The sun, wind, and an engine that runs. */
static void a_day(void)
{
    enclose(288);
    weather.sun_d_enu[0] = 0.48, weather.sun_d_enu[1] = -0.64, weather.sun_d_enu[2] = 0.6;
    weather.direct_w_m2 = 700, weather.diffuse_w_m2 = 90, weather.longwave_w_m2 *= 0.8, weather.ground_rho = 0.2;
    weather.ground_k = 300, weather.wind_enu_mps[0] = 2;
}

/* What is far away, a missile that flies by, frames that are drawn and the order of ids change no bit; what is near
 * does. */
static void what_must_change_no_bit(void **state)
{
    (void)state;
    static Crowd crowd[6]; /* alone; with far ones; with a missile; two; the same with other ids; with frames drawn */
    for (int k = 0; k < 6; k++) {
        VehicleHeat *heat = start();
        Crowd       *c = &crowd[k];
        *c = (Crowd){0};
        a_day();
        if (k == 4) stand(c, truck, 3.5, 1, 0.4, (EntityDrives){.engine = 0.6f});
        stand(c, tank, 0, 0, 0, (EntityDrives){.engine = 0.6f});
        if (k == 1)
            for (int i = 0; i < 12; i++) stand(c, i % 2 ? tank : building, 500 + 40 * i, -300, i, (EntityDrives){0});
        if (k == 2) stand(c, missile, 2, 3, 0, (EntityDrives){.motor = 1});
        if (k == 3 || k == 5) stand(c, truck, 3.5, 1, 0.4, (EntityDrives){.engine = 0.6f});
        if (k == 5) {
            for (double t_s = 0; t_s <= 200; t_s += 1) {
                run(heat, c, t_s, t_s);
                c->snapshot.t_s = t_s + 0.41;
                CHECK(vehicle_heat_show(heat, &c->snapshot, stage.arena) == STATUS_OK);
            }
        }
        if (k != 5) run(heat, c, 0, 200);
        c->snapshot.t_s = 200.6;
        CHECK(vehicle_heat_show(heat, &c->snapshot, stage.arena) == STATUS_OK);
        vehicle_heat_destroy(heat);
    }
    CHECK(worst_of(&crowd[0], 0, &crowd[1], 0) == 0);
    CHECK(worst_of(&crowd[0], 0, &crowd[2], 0) == 0);
    print_message("a truck beside it: up to %.2f K\n", worst_of(&crowd[0], 0, &crowd[3], 0));
    CHECK(worst_of(&crowd[0], 0, &crowd[3], 0) > 1);
    CHECK(worst_of(&crowd[3], 0, &crowd[4], 1) == 0 && worst_of(&crowd[3], 1, &crowd[4], 0) == 0);
    CHECK(worst_of(&crowd[3], 0, &crowd[5], 0) == 0 && worst_of(&crowd[3], 1, &crowd[5], 1) == 0);
}

/* A truck behind an aircraft's engine is warmed as far as its jet is warm; beside it, or with the engine off, not at
 * all. */
static void a_jet_warms_what_is_behind_it(void **state)
{
    (void)state;
    static const double     front[3] = {1, 0, 0};
    static const ExhaustJet outlet = {
        .at_body = {-5, 0, -1.2}, .d_body = {-1, 0, 0}, .radius_m = 0.4, .speed_mps = 300, .excess_k = 500};
    double front_k[4];
    for (int k = 0; k < 4; k++) { /* behind; no outlet; engine off; beside */
        Crowd        c = {0};
        VehicleHeat *heat = start();
        enclose(288);
        stand(&c, truck, 0, 0, 0, (EntityDrives){0}); /* nose north */
        stand(&c, tank, k == 3 ? 20 : 0, 25, 0, (EntityDrives){.engine = k == 2 ? 0 : 1.0f});
        c.entity[1].exhaust = k == 1 ? NULL : &outlet;
        run(heat, &c, 0, 300);
        front_k[k] = side_k(&c, 0, front);
        vehicle_heat_destroy(heat);
    }
    print_message("front of a truck 20 m behind a jet %.1f K; without one %.2f, stopped %.2f, beside it %.2f K\n",
                  front_k[0], front_k[1], front_k[2], front_k[3]);
    CHECK(front_k[0] > 288 + 20 && front_k[0] < 288 + 500);
    CHECK_NEAR(front_k[1], 288, 1);
    CHECK_NEAR(front_k[2], 288, 0.1);
    CHECK_NEAR(front_k[3], 288, 0.5);
}

/* A wreck that burns warms the side of a truck that faces it. */
static void a_burning_wreck_warms_the_side_that_faces_it(void **state)
{
    (void)state;
    static const double right[3] = {0, 1, 0}, left[3] = {0, -1, 0};
    Crowd               c = {0};
    VehicleHeat        *heat = start();
    enclose(288);
    stand(&c, truck, 0, 0, 0, (EntityDrives){0});
    const int wreck = stand(&c, tank, 5, 0, 0, (EntityDrives){0});
    run(heat, &c, 0, 60);
    CHECK_NEAR(side_k(&c, 0, right), 288, 0.01);
    c.entity[wreck].drives.burning = 1;
    run(heat, &c, 61, 660);
    print_message("beside a wreck that burned ten minutes at %.0f K: near side %.1f, far side %.1f K\n",
                  side_k(&c, wreck, left), side_k(&c, 0, right), side_k(&c, 0, left));
    CHECK(side_k(&c, 0, right) > 288 + 15 && side_k(&c, 0, right) < side_k(&c, wreck, left));
    CHECK(side_k(&c, 0, left) < 288 + 0.2 * (side_k(&c, 0, right) - 288));
    vehicle_heat_destroy(heat);
}

/* A wreck that burns 100 m away warms nothing; towed here, it is felt within three seconds, and no longer once it
 * has left. */
static void who_comes_is_felt_and_who_leaves_is_not(void **state)
{
    (void)state;
    static const double right[3] = {0, 1, 0};
    Crowd               c = {0}, here = {0};
    VehicleHeat        *heat = start();
    double              side[4];
    enclose(288);
    stand(&c, truck, 0, 0, 0, (EntityDrives){0});
    stand(&c, tank, 100, 0, 0, (EntityDrives){.burning = 1});
    stand(&here, tank, 5, 0, 0, (EntityDrives){.burning = 1});
    run(heat, &c, 0, 300);
    side[0] = side_k(&c, 0, right);
    const size_t alone_bytes = vehicle_heat_bytes(heat);
    memcpy(c.entity[1].p_ecef, here.entity[0].p_ecef, sizeof here.entity[0].p_ecef);
    run(heat, &c, 301, 304);
    side[1] = side_k(&c, 0, right);
    CHECK(vehicle_heat_bytes(heat) > alone_bytes);
    run(heat, &c, 305, 500);
    side[2] = side_k(&c, 0, right);
    c.snapshot.count = 1;
    run(heat, &c, 501, 3000);
    side[3] = side_k(&c, 0, right);
    print_message(
        "side of a truck: %.2f K, after 4 s by a wreck %.2f, after 200 s %.2f, 40 minutes after it left %.2f K\n",
        side[0], side[1], side[2], side[3]);
    CHECK_NEAR(side[0], 288, 1e-3);
    CHECK(side[1] > 288.1 && side[2] > side[1] + 10);
    CHECK(side[3] < 288 + 0.2 * (side[2] - 288));
    vehicle_heat_destroy(heat);
}

/* Eight are seen, the closest ones; more are counted. */
static void neighbours_are_bounded(void **state)
{
    (void)state;
    Neighbours   found;
    NearBody     body[16];
    const double sun[3] = {0, 0, -1};
    for (int i = 0; i < 16; i++)
        body[i] = (NearBody){
            .id = {1, 1, (uint16_t)(i + 1)}, .p_enu = {i == 0 ? 0 : 2.5 * (17 - i) + 1.5, 0, 0}, .radius_m = 3};
    vehicle_neighbours_find(&found, body, 16, 0, sun, false);
    CHECK(found.count == near_seen_most && found.left_out == 7);
    for (int k = 0; k < found.count; k++) CHECK(found.of[k].body == 15 - k && found.of[k].why == NEAR_SEEN);
    /* the same share: by id */
    for (int i = 1; i < 16; i++) body[i].p_enu[0] = i % 2 ? 12 : -12;
    vehicle_neighbours_find(&found, body, 16, 0, sun, false);
    for (int k = 0; k < found.count; k++) CHECK(found.of[k].body == k + 1);
    /* a jet, and the sun behind one of them */
    body[15].jet_m = 100;
    vehicle_neighbours_find(&found, body, 16, 0, (const double[3]){1, 0, 1e-3}, false);
    int jets = 0, suns = 0;
    for (int k = 0; k < found.count; k++)
        jets += (found.of[k].why & NEAR_JET) != 0, suns += (found.of[k].why & NEAR_SUN) != 0;
    CHECK(jets == 1 && suns == 8 &&
          found.count == 12); /* eight are seen, four more stand in the sun, the last blows too */
    VehicleHeat *heat = start();
    Crowd        c = {0};
    enclose(288);
    for (int i = 0; i < 12; i++) stand(&c, tank, 6 * (i % 4), 10 * (i / 4), 0, (EntityDrives){0});
    run(heat, &c, 0, 3);
    CHECK(vehicle_heat_counters(heat)->neighbours_left_out > 0);
    vehicle_heat_destroy(heat);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plates_see_each_other_as_published),
        cmocka_unit_test(a_hot_wreck_warms_as_its_view_factor_says),
        cmocka_unit_test(a_wall_sends_light),
        cmocka_unit_test(what_one_loses_the_other_gains),
        cmocka_unit_test(an_enclosure_of_several_stays_as_it_is),
        cmocka_unit_test(shade_is_as_no_sun),
        cmocka_unit_test(what_must_change_no_bit),
        cmocka_unit_test(a_jet_warms_what_is_behind_it),
        cmocka_unit_test(a_burning_wreck_warms_the_side_that_faces_it),
        cmocka_unit_test(who_comes_is_felt_and_who_leaves_is_not),
        cmocka_unit_test(neighbours_are_bounded),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
