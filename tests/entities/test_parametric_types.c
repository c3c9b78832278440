/* The carrier, launcher, aircraft, ship, person, building, decoy and flare: published figures, closed forms, and what
 * their joints do when an exercise moves them. labels: physics */
#include "tests/entities/model_fixture.h"

#include "entities/motion/articulation.h"
#include "entities/shapes/parts_private.h"

/* ---- size ------------------------------------------------------------------------------------- */

static void boxes_are_the_published_ones(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double      length_m, width_m, height_m, tolerance_m;
    } published[] = {
        /* 1 mm: a track's cleat may stand that much off the ground; curved outlines lose up to the sag of 1 mm */
        {"carrier", 5.258, 2.819, 2.794, 0.002},
        {"launcher", 7.389, 3.18, 3.45, 0.003},
        {"ship", 93.5, 14.0, 4.3 + 26.9, 0.003}, /* draught and the mast head's ball, which is an estimate */
        {"building", 8 + 0.4 * 0.7660 + 0.125 + 1.1, 10 + 2 * 0.4, 9.95, 0.01},
        {"decoy", 9.53, 3.59, 2.19 + 0.14, 0.003}, /* the tank's, and the cushion of its hatch */
    };
    for (size_t i = 0; i < sizeof published / sizeof published[0]; i++) {
        Model m = build(published[i].name, 0.001);
        CHECK_NEAR(m.length_m, published[i].length_m, published[i].tolerance_m);
        CHECK_NEAR(m.width_m, published[i].width_m, published[i].tolerance_m);
        CHECK_NEAR(m.height_m, published[i].height_m, published[i].tolerance_m);
        model_destroy(&m);
    }
    Model person = build("person", 2e-4), flare = build("flare", 1e-5), aircraft = build("aircraft", 0.001);
    CHECK_NEAR(person.height_m, 1.80, 2e-4);
    CHECK(person.width_m > 0.6 && person.width_m < 0.8 && person.length_m < 1.0); /* elbows out, pack to muzzle */
    CHECK_NEAR(flare.length_m, 0.148, 1e-12);
    CHECK_NEAR(flare.width_m, 0.036, 1e-3); /* six lands: the widest is where two flank the middle */
    CHECK_NEAR(flare.height_m, 0.036, 1e-9);
    CHECK_NEAR(aircraft.length_m, 15.06, 1e-9);
    CHECK_NEAR(aircraft.width_m, 9.45, 0.002);
    CHECK_NEAR(-aircraft.box_low[2], 5.09, 1e-9); /* fin over the ground below the wheels */
    model_destroy(&person);
    model_destroy(&flare);
    model_destroy(&aircraft);

    double low[3], high[3];
    Model  carrier = build("carrier", 0.001), ship = build("ship", 0.01), launcher = build("launcher", 0.001);
    part_box(low, high, &carrier, "hull", NULL);
    CHECK_NEAR(high[2], -0.432, 1e-12); /* ground clearance */
    part_box(low, high, &carrier, "turret", NULL);
    CHECK_NEAR(-low[2], 2.619 + 0.04, 0.002); /* roof, and its hatch */
    part_box(low, high, &carrier, "track_left", NULL);
    CHECK_NEAR(0.5 * (low[1] + high[1]), -2.159 / 2, 1e-12);
    CHECK_NEAR(high[1] - low[1], 0.381, 1e-12);
    part_box(low, high, &launcher, "missiles", NULL);
    const double tail_m = low[0];
    part_box(low, high, &launcher, "radomes", NULL);
    CHECK_NEAR(high[0] - tail_m, 5.80, 1e-9);
    part_box(low, high, &ship, "bottom", NULL);
    CHECK_NEAR(high[2], 4.3, 1e-9);
    CHECK_NEAR(low[2], 0, 1e-12);             /* painted to the waterline */
    CHECK_NEAR(high[0] - low[0], 85.2, 0.30); /* the last 25 cm taper to nothing and are left off */
    model_destroy(&carrier);
    model_destroy(&ship);
    model_destroy(&launcher);
}

static void they_stand_on_the_ground(void **state)
{
    (void)state;
    static const char *const standing[] = {"carrier", "launcher", "person", "building", "decoy", "flare"};
    for (double sag_m = 0.1; sag_m > 0.9e-3; sag_m *= 0.464158883) /* 0.1 .. 0.001 in three steps a decade */
        for (size_t i = 0; i < sizeof standing / sizeof standing[0]; i++) {
            Model m = build(standing[i], sag_m);
            CHECK(m.box_high[2] <= 1e-12);
            /* tracks: facets of the belt, and the millimetre of a cleat's corner */
            CHECK(m.box_high[2] >= -sag_m - 0.0011);
            model_destroy(&m);
        }
}

/* Archimedes: the volume below the waterline weighs what the books say, 2,950 t in sea water. The lines are drawn
 * through the published length, beam and draught, and nothing else holds them to this but one fullness. */
static void the_ship_floats_at_its_waterline(void **state)
{
    (void)state;
    Model        m = build("ship", 0.005);
    const double volume_m3 = part_volume_m3(&m, find_part(&m, "bottom"));
    CHECK_NEAR(volume_m3 / (2950 / 1.025), 1, 0.05); /* tonnes at full load vary by 5 % between books and years */
    CHECK_NEAR(volume_m3 / (85.2 * 14.0 * 4.3), 0.55, 0.05); /* block coefficient: frigates have 0.5 .. 0.6 */
    /* its middle is near the middle of the ship, or it would trim */
    const ModelPart *p = find_part(&m, "bottom");
    double           moment = 0;
    for (int t = p->first_triangle; t < p->first_triangle + p->triangle_count; t++) {
        const double *a = m.vertex[m.triangle[t][0]], *b = m.vertex[m.triangle[t][1]], *c = m.vertex[m.triangle[t][2]];
        double        cross[3];
        v3_cross(cross, b, c);
        moment += v3_dot(a, cross) / 24 * (a[0] + b[0] + c[0]);
    }
    CHECK(fabs(moment / volume_m3) < 0.04 * 85.2);
    model_destroy(&m);
}

/* Area in plan of a part's upper side, m2. */
static double plan_area_m2(const Model *m, const char *name)
{
    double area = 0;
    for (int i = 0; i < m->part_count; i++) {
        const ModelPart *p = &m->part[i];
        if (strcmp(p->name, name) != 0) continue;
        for (int t = p->first_triangle; t < p->first_triangle + p->triangle_count; t++) {
            double u[3], v[3], n[3];
            v3_sub(u, m->vertex[m->triangle[t][1]], m->vertex[m->triangle[t][0]]);
            v3_sub(v, m->vertex[m->triangle[t][2]], m->vertex[m->triangle[t][0]]);
            v3_cross(n, u, v);
            area += fmax(-0.5 * n[2], 0); /* z is down */
        }
    }
    return area;
}

static void the_wing_has_its_area(void **state)
{
    (void)state;
    /* from area, aspect ratio and taper alone */
    const double area = 27.87, aspect = 3.0, taper = 0.21, span = sqrt(aspect * area);
    const double root = 2 * area / (span * (1 + taper)), tip = taper * root;
    Model        m = build("aircraft", 0.005);
    /* what shows outside the fuselage at 0.62 m: a trapezium a side; the rails and pylons have no part in it */
    const double from = 0.62, chord = root + (tip - root) * from / (0.5 * span);
    const double want = (0.5 * span - from) * (chord + tip);
    double rails = 0; /* drawn in the same part: two bodies of revolution and four pylons, from their own figures */
    const double r = 0.5 * (9.45 - 9.144) / 2;
    const int    n = mesh_circle_sides(r, 0.005);
    rails += 2 * (2 * r * 1.65 + r * 0.30) * (n % 4 == 0 ? 1 : cos(pi_rad / n));
    rails += 2 * 0.06 * (1.7 + 1.3);
    const double gaps = 2 * 0.01 * 0.22 * (4.35 + 2.48); /* a centimetre at each end of a flaperon, 22 % of the chord */
    CHECK_NEAR((plan_area_m2(&m, "wings") - rails + plan_area_m2(&m, "flaperon") + gaps) / want, 1, 2e-3);
    model_destroy(&m);
}

static void houses_and_grains_have_their_volume(void **state)
{
    (void)state;
    const double tan40 = 0.83909963117728;
    for (double sag_m = 0.1; sag_m > 0.9e-3; sag_m *= 0.1) {
        Model house = build("building", sag_m);
        CHECK_NEAR(part_volume_m3(&house, find_part(&house, "walls")), 10 * (8 * (5.4 - 0.35) + 4 * 4 * tan40), 1e-9);
        CHECK_NEAR(part_volume_m3(&house, find_part(&house, "windows")), 19 * 1.08 * 1.22 * 0.04, 1e-12);
        CHECK_NEAR(part_volume_m3(&house, find_part(&house, "plinth")), 10.06 * 8.06 * 0.35 + 1.1 * 2 * 0.17, 1e-9);
        /* 12 cm of tiles on two slopes, and an upper bound for the ridge's bar */
        const double slopes = 2 * 10.8 * (4 / 0.76604444 + 0.4) * 0.12;
        const double roof = part_volume_m3(&house, find_part(&house, "roof"));
        CHECK(roof > slopes && roof < slopes + 10.8 * pi_rad * 0.11 * 0.11);
        model_destroy(&house);
    }
    Model        flare = build("flare", 1e-5);
    const double core = pi_rad * 0.0162 * 0.0162 * 0.138, land = 0.5 * (0.011 + 0.009) * 0.003 * 0.136;
    CHECK_NEAR(part_volume_m3(&flare, find_part(&flare, "grain")) / (core + 6 * land), 1, 2e-3); /* polygon's share */
    model_destroy(&flare);

    /* a man of 75 kg has 0.075 m3; cloth, and limbs that run into the trunk, add to it: neither half nor double */
    Model        person = build("person", 1e-3);
    const double body =
        part_volume_m3(&person, find_part(&person, "uniform")) + part_volume_m3(&person, find_part(&person, "skin"));
    CHECK(body > 0.06 && body < 0.11);
    model_destroy(&person);
}

/* ---- facets ------------------------------------------------------------------------------------- */

static void no_triangle_is_degenerate(void **state)
{
    (void)state;
    for (double sag_m = 0.1; sag_m > 0.9e-3; sag_m *= 0.1)
        for (int i = 0; i < model_name_count; i++) {
            Model m = build(model_names[i], sag_m);
            for (int t = 0; t < m.triangle_count; t++) {
                double e[3][3], n[3], longest = 0;
                for (int k = 0; k < 3; k++) {
                    v3_sub(e[k], m.vertex[m.triangle[t][(k + 1) % 3]], m.vertex[m.triangle[t][k]]);
                    longest = fmax(longest, v3_length(e[k]));
                }
                v3_cross(n, e[0], e[1]);
                /* height over the longest side against rounding of coordinates of some metres */
                if (!(v3_length(n) / longest > 1e-9))
                    fail_msg("%s at %g: part %s has a sliver %g high", m.name, sag_m, m.part[m.triangle_part[t]].name,
                             v3_length(n) / longest);
            }
            model_destroy(&m);
        }
}

/* Distance from a point to a triangle (Ericson, Real-Time Collision Detection, 5.1.5: by regions). */
static double triangle_distance(const double p[3], const double *a, const double *b, const double *c)
{
    double ab[3], ac[3], ap[3], bp[3], cp[3], q[3];
    v3_sub(ab, b, a);
    v3_sub(ac, c, a);
    v3_sub(ap, p, a);
    v3_sub(bp, p, b);
    v3_sub(cp, p, c);
    const double d1 = v3_dot(ab, ap), d2 = v3_dot(ac, ap), d3 = v3_dot(ab, bp), d4 = v3_dot(ac, bp);
    const double d5 = v3_dot(ab, cp), d6 = v3_dot(ac, cp);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    double       v, w;
    if (d1 <= 0 && d2 <= 0) v = w = 0;
    else if (d3 >= 0 && d4 <= d3) v = 1, w = 0;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0) v = d1 / (d1 - d3), w = 0;
    else if (d6 >= 0 && d5 <= d6) v = 0, w = 1;
    else if (vb <= 0 && d2 >= 0 && d6 <= 0) v = 0, w = d2 / (d2 - d6);
    else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) w = (d4 - d3) / (d4 - d3 + d5 - d6), v = 1 - w;
    else v = vb / (va + vb + vc), w = vc / (va + vb + vc);
    for (int i = 0; i < 3; i++) q[i] = ap[i] - v * ab[i] - w * ac[i];
    return v3_length(q);
}

/* A coarse model against a fine one of itself: random points of its facets lie within the two sags of the fine
 * surface. It finds what was refined in one direction and forgotten in another. */
static void coarse_models_keep_to_fine_ones(void **state)
{
    (void)state;
    static const struct {
        const char *name, *part;
        double      coarse_m, fine_m;
    } pair[] = {
        {"ship", "hull", 0.05, 0.005},          {"ship", "bottom", 0.05, 0.005},
        {"aircraft", "fuselage", 0.02, 0.001},  {"aircraft", "canopy", 0.02, 0.001},
        {"person", "uniform", 0.01, 0.0005},    {"person", "helmet", 0.01, 0.0005},
        {"decoy", "hull", 0.02, 0.002},         {"decoy", "turret", 0.02, 0.002},
        {"launcher", "radomes", 0.01, 0.0005},  {"launcher", "missiles", 0.01, 0.001},
        {"carrier", "track_left", 0.01, 0.001},
    };
    for (size_t i = 0; i < sizeof pair / sizeof pair[0]; i++) {
        Model            coarse = build(pair[i].name, pair[i].coarse_m), fine = build(pair[i].name, pair[i].fine_m);
        const ModelPart *c = find_part(&coarse, pair[i].part), *f = find_part(&fine, pair[i].part);
        double           worst = 0;
        for (int k = 0; k < 250; k++) {
            double random[3];
            for (int r = 0; r < 3; r++) random[r] = random_uniform(11, (uint32_t)r, (uint32_t)i, (uint64_t)k);
            const double u = random[0], v = random[1];
            const int    t = c->first_triangle + (int)(random[2] * c->triangle_count);
            const double s = sqrt(u), at[3] = {1 - s, s * (1 - v), s * v};
            double       p[3] = {0, 0, 0}, n[3], e[2][3], least = INFINITY;
            for (int k3 = 0; k3 < 3; k3++) v3_add_scaled(p, p, at[k3], coarse.vertex[coarse.triangle[t][k3]]);
            v3_sub(e[0], coarse.vertex[coarse.triangle[t][1]], coarse.vertex[coarse.triangle[t][0]]);
            v3_sub(e[1], coarse.vertex[coarse.triangle[t][2]], coarse.vertex[coarse.triangle[t][0]]);
            v3_cross(n, e[0], e[1]);
            /* the caps between a hull's slabs are inside it, on no surface */
            if (!strcmp(pair[i].name, "ship") && fabs(n[0]) > 0.99 * v3_length(n)) continue;
            const int end = f->first_triangle + f->triangle_count;
            for (int q = f->first_triangle; q < end && least > 0.1 * pair[i].fine_m; q++) {
                const double *corner[3];
                for (int k3 = 0; k3 < 3; k3++) corner[k3] = fine.vertex[fine.triangle[q][k3]];
                least = fmin(least, triangle_distance(p, corner[0], corner[1], corner[2]));
            }
            worst = fmax(worst, least);
        }
        if (!(worst <= pair[i].coarse_m + pair[i].fine_m))
            fail_msg("%s %s: %g m off at a sag of %g", pair[i].name, pair[i].part, worst, pair[i].coarse_m);
        CHECK(worst > 0.02 * pair[i].coarse_m); /* and the coarse one is coarser */
        model_destroy(&coarse);
        model_destroy(&fine);
    }
}

/* A limb is the hull of two balls: distance in closed form. */
static void limbs_keep_to_the_sag(void **state)
{
    (void)state;
    static const double from[3] = {0.3, -0.2, -1.0}, to[3] = {0.5, 0.3, -1.6};
    const double        r0 = 0.25, r1 = 0.12;
    double              axis[3];
    v3_sub(axis, to, from);
    const double length = v3_length(axis), cosine = (r0 - r1) / length, sine = sqrt(1 - cosine * cosine);
    v3_scale(axis, 1 / length, axis);
    for (double sag_m = 0.03; sag_m > 1e-5; sag_m *= 0.3) {
        Model        m = {0};
        MeshBuilder *b = mesh_builder_create("limb", sag_m);
        CHECK(b != NULL);
        mesh_node(b, "hull", -1, 0, 0, 0);
        mesh_part(b, 0, "limb", "skin", HEAT_SKIN);
        parts_limb(b, from, r0, to, r1);
        CHECK(mesh_builder_finish(&m, b) == STATUS_OK);
        CHECK(model_validate(&m) == STATUS_OK);
        double worst = 0;
        for (int t = 0; t < m.triangle_count; t++) {
            double p[3] = {0, 0, 0}, d[3], off[3];
            for (int k = 0; k < 3; k++) v3_add_scaled(p, p, 1 / 3.0, m.vertex[m.triangle[t][k]]);
            v3_sub(d, p, from);
            const double h = v3_dot(d, axis);
            v3_add_scaled(off, d, -h, axis);
            const double r = v3_length(off);
            /* nearest to the first ball, the second, or the cone between, by where the normals point */
            const double along = h * sine - r * cosine;
            const double gap = along < 0               ? hypot(h, r) - r0
                               : along > length * sine ? hypot(h - length, r) - r1
                                                       : h * cosine + r * sine - r0;
            worst = fmax(worst, fabs(gap));
        }
        CHECK(worst <= sag_m);
        CHECK(worst >= 0.1 * sag_m || sag_m > 0.02);
        model_destroy(&m);
    }
}

/* ---- what moves ---------------------------------------------------------------------------------- */

static DisVariableParameter articulated(uint32_t parameter, double value)
{
    return (DisVariableParameter){
        .record_type = dis_variable_articulated, .parameter = parameter, .value = (float)value};
}

static void joints_answer_to_their_class(void **state)
{
    (void)state;
    static const struct {
        const char *model, *node;
        uint32_t    dis_class, metric;
        double      low_deg, high_deg;
    } joint[] = {
        {"carrier", "turret", 4096, 11, 1, -1},
        {"carrier", "gun", 4416, 13, -10, 50},
        {"carrier", "cupola", 5696, 11, 1, -1},
        {"carrier", "machine_gun", 6016, 13, -10, 60},
        {"launcher", "turntable", 4096, 11, 1, -1},
        {"launcher", "rails", 4736, 13, 0, 80},
        {"aircraft", "flaperon_left", 1120, 13, -23, 20},
        {"aircraft", "flaperon_right", 1152, 13, -23, 20},
        {"aircraft", "stabilator_left", 1408, 13, -25, 25},
        {"aircraft", "stabilator_right", 1440, 13, -25, 25},
        {"aircraft", "rudder", 1024, 11, -30, 30},
        {"ship", "turret", 4096, 11, 1, -1},
        {"ship", "gun", 4416, 13, -15, 80},
        {"ship", "mount_left", 5696, 11, 1, -1},
        {"ship", "mount_right", 5728, 11, 1, -1},
        {"ship", "small_gun_left", 6016, 13, -10, 60},
        {"ship", "small_gun_right", 6048, 13, -10, 60},
        {"ship", "radar", 5376, 11, 1, -1},
    };
    for (size_t i = 0; i < sizeof joint / sizeof joint[0]; i++) {
        Model            m = build(joint[i].model, 0.02);
        const ModelNode *node = &m.node[find_node(&m, joint[i].node)];
        assert_int_equal(node->dis_class, joint[i].dis_class);
        assert_int_equal(node->dis_metric, joint[i].metric);
        if (joint[i].low_deg > joint[i].high_deg) CHECK(node->low > node->high);
        else {
            CHECK_NEAR(node->low, joint[i].low_deg * rad_per_deg, 1e-15);
            CHECK_NEAR(node->high, joint[i].high_deg * rad_per_deg, 1e-15);
        }
        /* azimuth about down: ahead goes to the right; elevation: ahead goes up */
        double   value[64] = {0}, ahead[3];
        NodePose pose[64];
        value[node - m.node] = 0.1;
        model_pose(pose, &m, value);
        m3_mul_v3(ahead, pose[node - m.node].r_body_from_node, (double[3]){1, 0, 0});
        CHECK(joint[i].metric == 11 ? ahead[1] > 0.05 : ahead[2] < -0.05);
        model_destroy(&m);
    }
}

static void guns_lift_and_missiles_rise(void **state)
{
    (void)state;
    static const struct {
        const char *model, *node, *part;
        /* tip: ahead of and above the joint's axis, and the radius there; top: of the part at rest */
        double angle_deg, ahead_m, above_m, tip_radius_m, top_m;
    } lift[] = {
        {"carrier", "gun", "barrel", 50, 2.15, 0, 0.040, 0.055},
        {"ship", "gun", "barrel", 80, 5.75, 0, 0.130, 0.160},
        {"launcher", "rails", "radomes", 80, 7.389 - 3.45 + 1.5, 0.586, 0, 0.586 + 0.1675},
    };
    for (size_t i = 0; i < 3; i++) {
        Model  m = build(lift[i].model, 0.005);
        double value[64] = {0}, low[3], high[3], up_low[3], up_high[3];
        value[find_node(&m, lift[i].node)] = 2; /* past its limit: the highest it goes */
        part_box(low, high, &m, lift[i].part, NULL);
        part_box(up_low, up_high, &m, lift[i].part, value);
        const double s = sin(lift[i].angle_deg * rad_per_deg), c = cos(lift[i].angle_deg * rad_per_deg);
        /* within a centimetre: the sag, and the ogive's flank beside its tip */
        const double top_m = lift[i].ahead_m * s + (lift[i].above_m + lift[i].tip_radius_m) * c;
        CHECK_NEAR(low[2] - up_low[2], top_m - lift[i].top_m, 0.01);
        /* and round to the right with the mount */
        memset(value, 0, sizeof value);
        value[m.node[find_node(&m, lift[i].node)].parent] = 0.5 * pi_rad;
        part_box(up_low, up_high, &m, lift[i].part, value);
        CHECK(up_high[1] > high[1] + 1.0);
        model_destroy(&m);
    }
}

/* A ramp reported open (position 1) lies with its top on the ground behind; 0 shuts it. */
static void the_ramp_opens(void **state)
{
    (void)state;
    Model                      m = build("carrier", 0.005);
    const DisVariableParameter open = articulated(3232 + 1, 1);
    Articulation               a = {0};
    double                     value[64], low[3], high[3];
    assert_int_equal(articulation_report(&a, &open, 1, 0, 5), 0);
    articulation_joint_values(value, &m, &a, &(JointDrive){0}, 0, 5);
    CHECK_NEAR(value[find_node(&m, "ramp")], 2.02, 1e-6);
    part_box(low, high, &m, "ramp", value);
    CHECK_NEAR(high[2], 0, 0.05); /* its outer face touches the ground, within 5 cm */
    CHECK(high[2] <= 0 && low[0] < -3.5);
    part_box(low, high, &m, "ramp", NULL);
    CHECK(low[0] > -2.63 && low[2] < -1.85); /* shut, it closes the rear */
    model_destroy(&m);
}

/* Down when slow or told so, up otherwise; down it stands on the ground, up it is inside. */
static void landing_gear_follows_speed_and_report(void **state)
{
    (void)state;
    static const char *const leg[3] = {"gear_nose", "gear_left", "gear_right"};
    for (double sag_m = 0.1; sag_m > 0.9e-3; sag_m *= 0.1) {
        Model m = build("aircraft", sag_m);
        for (int way = 0; way < 4; way++) {
            const bool fast = way & 1, told = way & 2, down = told ? fast : !fast; /* told the opposite of the usual */
            const DisVariableParameter said = articulated(3072 + 1, down);
            Articulation               a = {0};
            double                     value[64];
            NodePose                   pose[64];
            if (told) assert_int_equal(articulation_report(&a, &said, 1, 0, 5), 0);
            articulation_joint_values(value, &m, &a, &(JointDrive){.speed_mps = fast ? 200 : 0}, 0, 5);
            model_pose(pose, &m, value);
            for (int i = 0; i < 3; i++) {
                const int wheel = find_node(&m, leg[i]) + 1; /* the wheel follows its leg */
                CHECK(m.node[wheel].roll_radius_m > 0.2);
                const double hub_m = -pose[wheel].p_body[2], radius_m = m.node[wheel].roll_radius_m;
                if (down) {
                    CHECK_NEAR(hub_m, radius_m, 1e-9);
                    double side[3]; /* upright, the axle across: it can roll */
                    m3_mul_v3(side, pose[wheel].r_body_from_node, (double[3]){0, 1, 0});
                    CHECK_NEAR(side[1], 1, 1e-9);
                } else {
                    CHECK(hub_m > 1.2 && fabs(pose[wheel].p_body[1]) < 0.5); /* within the fuselage's sides */
                }
            }
            if (down) { /* track and wheel base */
                const double *nose = pose[find_node(&m, "gear_nose") + 1].p_body;
                const double *left = pose[find_node(&m, "gear_left") + 1].p_body;
                const double *right = pose[find_node(&m, "gear_right") + 1].p_body;
                CHECK_NEAR(right[1] - left[1], 2.36, 1e-9);
                CHECK_NEAR(nose[0] - left[0], 4.00, 1e-9);
            }
        }
        model_destroy(&m);
    }
}

static void control_surfaces_turn_the_right_way(void **state)
{
    (void)state;
    Model                    m = build("aircraft", 0.01);
    static const char *const surface[4] = {"flaperon_left", "flaperon_right", "stabilator_left", "stabilator_right"};
    for (int i = 0; i < 4; i++) {
        double    value[64] = {0}, before[3], after[3];
        NodePose  rest[64], moved[64];
        const int n = find_node(&m, surface[i]);
        value[n] = 0.2;
        model_pose(rest, &m, NULL);
        model_pose(moved, &m, value);
        const double trailing[3] = {-0.3, 0, 0};
        m3_mul_v3(before, rest[n].r_body_from_node, trailing);
        m3_mul_v3(after, moved[n].r_body_from_node, trailing);
        CHECK(after[2] > before[2] + 0.04); /* the trailing edge goes down */
        CHECK(fabs(after[1] - before[1]) < 0.02);
    }
    double    value[64] = {0}, trailing[3];
    NodePose  pose[64];
    const int rudder = find_node(&m, "rudder");
    value[rudder] = 0.2;
    model_pose(pose, &m, value);
    m3_mul_v3(trailing, pose[rudder].r_body_from_node, (double[3]){-1, 0, 0});
    CHECK(trailing[1] < -0.15); /* to the left */
    model_destroy(&m);
}

static void the_radar_turns_by_itself(void **state)
{
    (void)state;
    Model     m = build("ship", 0.05);
    const int radar = find_node(&m, "radar");
    CHECK_NEAR(m.node[radar].spin_rps_moving, 2.513, 0.001); /* 24 rpm */
    Articulation a = {0};
    double       value[64];
    articulation_joint_values(value, &m, &a, &(JointDrive){.spin_s = 0.5}, 0, 5);
    CHECK_NEAR(value[radar], 1.2566, 1e-3);
    const DisVariableParameter said = articulated(5376 + 11, -0.4);
    assert_int_equal(articulation_report(&a, &said, 1, 0, 5), 0);
    articulation_joint_values(value, &m, &a, &(JointDrive){.spin_s = 0.5}, 0, 5);
    CHECK_NEAR(value[radar], -0.4, 1e-6);
    model_destroy(&m);
}

/* ---- what they are made of ------------------------------------------------------------------------- */

static void roles_and_sides(void **state)
{
    (void)state;
    static const struct {
        const char *model, *part;
        HeatRole    role;
        double      x_sign, y_sign; /* which half it lies in; 0: either */
    } want[] = {
        {"carrier", "exhaust", HEAT_EXHAUST, 1, 1},   {"carrier", "engine_deck", HEAT_ENGINE_DECK, 1, 0},
        {"carrier", "ramp", HEAT_CABIN, -1, 0},       {"carrier", "track_left", HEAT_TRACK, 0, -1},
        {"launcher", "exhaust", HEAT_EXHAUST, -1, 1}, {"launcher", "engine_deck", HEAT_ENGINE_DECK, -1, 0},
        {"aircraft", "nozzle", HEAT_TURBINE, -1, 0},  {"aircraft", "canopy", HEAT_AIRFRAME, 1, 0},
        {"aircraft", "radome", HEAT_NOSE, 1, 0},      {"aircraft", "intake_mouth", HEAT_AIRFRAME, 1, 0},
        {"ship", "uptakes", HEAT_EXHAUST, -1, 0},     {"ship", "gun_turret", HEAT_TURRET, 1, 0},
        {"person", "skin", HEAT_SKIN, 0, 0},          {"person", "uniform", HEAT_CLOTHING, 0, 0},
        {"person", "pack", HEAT_PASSIVE, -1, 0},      {"building", "windows", HEAT_WINDOW, 0, 0},
        {"building", "door", HEAT_DWELLING, 1, 0},    {"building", "chimney", HEAT_FLUE, -1, 1},
        {"flare", "grain", HEAT_FLARE, 0, 0},
    };
    for (size_t i = 0; i < sizeof want / sizeof want[0]; i++) {
        Model  m = build(want[i].model, 0.01);
        double low[3], high[3];
        assert_int_equal(find_part(&m, want[i].part)->role, want[i].role);
        part_box(low, high, &m, want[i].part, NULL);
        CHECK(want[i].x_sign == 0 || want[i].x_sign * (low[0] + high[0]) > 0);
        CHECK(want[i].y_sign == 0 || want[i].y_sign * (low[1] + high[1]) > 0);
        model_destroy(&m);
    }
}

/* Of a tank's outline, but nothing in it is warm and nothing is metal. */
static void the_decoy_is_a_cold_tank_of_cloth(void **state)
{
    (void)state;
    char  path[512];
    Table table = {0};
    CHECK(etc_path(path, sizeof path, "materials.csv"));
    CHECK(table_open(&table, path) == STATUS_OK);
    const int name = table_column(&table, "name"), metal = table_column(&table, "metal");
    Model     decoy = build("decoy", 0.005), tank = build("tank", 0.005);
    CHECK_NEAR(decoy.length_m / tank.length_m, 1, 0.01);
    CHECK_NEAR(decoy.width_m / tank.width_m, 1, 0.01);
    int tank_metal = 0;
    for (int which = 0; which < 2; which++) {
        const Model *m = which ? &tank : &decoy;
        for (int p = 0; p < m->part_count; p++) {
            if (!which) assert_int_equal(m->part[p].role, HEAT_PASSIVE);
            for (int row = 0; row < table.rows; row++) {
                double is_metal;
                if (strcmp(table_text(&table, row, name), m->part[p].material) != 0) continue;
                CHECK(table_number(&is_metal, &table, row, metal, 0, 1) == STATUS_OK);
                if (which) tank_metal += is_metal > 0;
                else CHECK(is_metal == 0);
            }
        }
    }
    CHECK(tank_metal > 10);
    model_destroy(&decoy);
    model_destroy(&tank);
    table_close(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_are_the_published_ones),
        cmocka_unit_test(they_stand_on_the_ground),
        cmocka_unit_test(the_ship_floats_at_its_waterline),
        cmocka_unit_test(the_wing_has_its_area),
        cmocka_unit_test(houses_and_grains_have_their_volume),
        cmocka_unit_test(no_triangle_is_degenerate),
        cmocka_unit_test(coarse_models_keep_to_fine_ones),
        cmocka_unit_test(limbs_keep_to_the_sag),
        cmocka_unit_test(joints_answer_to_their_class),
        cmocka_unit_test(guns_lift_and_missiles_rise),
        cmocka_unit_test(the_ramp_opens),
        cmocka_unit_test(landing_gear_follows_speed_and_report),
        cmocka_unit_test(control_surfaces_turn_the_right_way),
        cmocka_unit_test(the_radar_turns_by_itself),
        cmocka_unit_test(roles_and_sides),
        cmocka_unit_test(the_decoy_is_a_cold_tank_of_cloth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
