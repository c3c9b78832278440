/* What an exercise says of its ground, and that those who stand, stand on it: heights against what the reports say.
 * labels: physics */
#include "tests/check.h"

#include "dis/pdu/pdu.h"
#include "entities/table/contact.h"
#include "sensor/node/choices/ground_evidence_private.h"
#include "tests/sensor/stood_exercise.h"

static void gather(GroundEvidence *out, const Exercise *e)
{
    assert_int_equal(ground_evidence_collect(out, &e->survey, &frame, catalog), STATUS_OK);
}

/* The ground as replay chooses it, with what it says. */
static void choose(Landscape *out, GroundContact *contact, Choices *choices, const Exercise *e, const char *ground)
{
    Config   config = config_default();
    HostPlan plan = {0};
    choices->count = 0;
    assert_int_equal(config_set(&config, "terrain.ground", ground, "test"), STATUS_OK);
    config.terrain.spacing_m = 8; /* a quarter of the time */
    assert_int_equal(stood_ground(out, contact, choices, e, &config, &plan), STATUS_OK);
}

/* Base of every report of a track above the ground, the farthest. */
static double off_m(const Landscape *land, const Exercise *e, int t)
{
    const ContactGround ground = {.frame = &land->frame, .elevation = &land->elevation};
    GroundEvidence      said;
    double              most = 0;
    gather(&said, e);
    for (int n = 0; n < e->track[t].count; n++) {
        double base_ecef[3];
        ground_evidence_base(base_ecef, &e->track[t].point[n], said.below_m[t]);
        const double above_m = contact_above_m(&ground, base_ecef);
        if (fabs(above_m) > fabs(most) || isnan(above_m)) most = above_m;
    }
    ground_evidence_free(&said);
    return most;
}

static SurfaceClass surface_under(const Landscape *land, const TrackPoint *point)
{
    double p_enu[3];
    enu_from_ecef(p_enu, &land->frame, point->p_ecef);
    return landscape_surface(land, p_enu[0], p_enu[1]);
}

/* A village with one tank: the ground is where any of them stands. */
static void standing_entities_say_where_the_ground_is(void **state)
{
    (void)state;
    Exercise     *e = fresh();
    Landscape     land;
    Choices       choices;
    GroundContact contact;
    stand(e, tank, 0, 0, 500, 5, 8);
    for (int n = 0; n < 4; n++) stand(e, man, 60 + 4 * n, 80, 506, 1.4, 8);
    stand(e, house, 150, 100, 512, 0, 3);
    stand(e, house, -150, -60, 488, 0, 3);
    stand(e, man, -140, -40, 489, 0, 3);
    stand(e, crate, 20, -60, 495, 0, 3);
    stand(e, radar_site, 250, 0, 520, 0, 3);
    stand(e, mine, 80, -30, 502, 0, 3);
    stand(e, sea_mine, 300, 300, 100, 0, 3);
    choose(&land, &contact, &choices, e, "auto");
    for (int t = 0; t < 11; t++) CHECK_NEAR(off_m(&land, e, t), 0, 0.05);
    CHECK(contact == GROUND_CONTACT_INCONSISTENT);
    CHECK(says(&choices, "fitted to 11 land entities"));
    CHECK(!strstr(choices.line[choices.count - 1], "not fit"));
    landscape_destroy(&land);
}

static void a_helicopter_that_hangs_is_not_parked(void **state)
{
    (void)state;
    GroundEvidence said;
    for (int soldiers = 0; soldiers < 2; soldiers++) {
        Exercise *e = fresh();
        for (int n = 0; n < 5; n++) stand(e, man, 20 + 6 * n, 5 * (n % 2), 300 + 0.02 * n, 1, 8);
        const int parked = e->survey.track_count;
        stand(e, helicopter, 30, 40, 300.5, 0, 8); /* among soldiers, as high as they */
        stand(e, helicopter, 60, 60, 320, 0, 8);   /* hangs 20 m above them, to the millimetre */
        stand(e, helicopter, 5000, 0, 340, 0, 8);  /* unknown */
        stand(e, jet, -5000, 0, 310, 0, 8);        /* wings do not hang */
        stand(e, jet, -6000, 0, 310, 60, 8);       /* flies */
        stand(e, helicopter, 25, 30, 300, 0, 2);   /* too short to tell */
        Track *frozen = stand(e, helicopter, 35, 30, 300, 0, 8);
        for (int n = 0; n < 8; n++) frozen->point[n].frozen = true;
        Track *sways = stand(e, helicopter, 35, 50, 300, 0, 8);
        for (int n = 0; n < 8; n++) sways->point[n].p_ecef[0] += 0.02 * (n & 1);
        if (!soldiers) /* without neighbours to compare with */
            for (int t = 0; t < parked; t++) e->track[t].type = (DisEntityType){.kind = 4};
        gather(&said, e);
        CHECK(said.stance[parked] == (soldiers ? STANCE_LANDED : STANCE_FLIES));
        CHECK(said.stance[parked + 1] == STANCE_FLIES);
        CHECK(said.stance[parked + 2] == STANCE_FLIES);
        CHECK(said.stance[parked + 3] == STANCE_LANDED);
        for (int t = parked + 4; t < parked + 8; t++) CHECK(said.stance[t] == STANCE_FLIES);
        ground_evidence_free(&said);

        /* its sender says which engines run: those that do not stand */
        for (int n = 0; n < 8; n++) e->track[parked + 1].point[n].engine = true;
        gather(&said, e);
        CHECK(said.stance[parked + 1] == STANCE_FLIES);
        CHECK(said.stance[parked + 2] == STANCE_LANDED);
        ground_evidence_free(&said);
    }
    /* it lands, stands, and takes off: the ground is under it and its way is clear */
    Exercise *e = fresh();
    for (int n = 0; n < 3; n++) stand(e, man, 20 + 6 * n, 0, 300, 1, 8);
    Track *lands = stand(e, helicopter, 30, 40, 300, 0, 12);
    for (int n = 0; n < 12; n++) {
        const double up_m = n < 3 ? 60 - 20 * n : n > 8 ? 20 * (n - 8) : 0;
        for (int k = 0; k < 3; k++) {
            lands->point[n].p_ecef[k] += up_m * frame.r_ecef_from_enu[3 * k + 2];
            lands->point[n].v_ecef_mps[k] += (up_m > 0 ? 10 : 0) * frame.r_ecef_from_enu[3 * k + 2];
        }
    }
    gather(&said, e);
    CHECK(said.stance[3] == STANCE_LANDED);
    for (int n = 0; n < 12; n++) CHECK(said.fixed[said.first[3] + (size_t)n] == (n >= 3 && n <= 8));
    CHECK(said.said.line_count == 6);
    ground_evidence_free(&said);
}

/* Four and one: 20 or 30 m below or above. */
static void a_misfit_is_set_onto_it_and_said(void **state)
{
    (void)state;
    static const double lie_m[] = {-30, -20, 20, 30};
    for (int k = 0; k < 4; k++) {
        Exercise     *e = fresh();
        Landscape     land;
        Choices       choices;
        GroundContact contact;
        char          want[64];
        for (int n = 0; n < 4; n++) stand(e, tank, -45 * n, 0, 500, 5, 8);
        stand(e, tank, -180, 0, 500 + lie_m[k], 5, 8);
        choose(&land, &contact, &choices, e, "auto");
        for (int t = 0; t < 4; t++) CHECK_NEAR(off_m(&land, e, t), 0, 0.05);
        CHECK_NEAR(off_m(&land, e, 4), lie_m[k], 5);
        CHECK(says(&choices, "fitted to 4 land entities"));
        CHECK(says(&choices, "ground: 1 entity does not fit it and is set onto it: 1:1:5 E5, sent "));
        snprintf(want, sizeof want, " m %s it", lie_m[k] < 0 ? "under" : "above");
        CHECK(says(&choices, want) && says(&choices, "(terrain.ground)"));
        landscape_destroy(&land);
        if (k > 0) continue;
        choose(&land, &contact, &choices, e, "trust");
        CHECK(contact == GROUND_CONTACT_NONE);
        CHECK(says(&choices, "does not fit it and stay"));
        landscape_destroy(&land);
        choose(&land, &contact, &choices, e, "clamp");
        CHECK(contact == GROUND_CONTACT_ALL && says(&choices, "are set onto the ground"));
        landscape_destroy(&land);
    }
}

static void ships_float_and_tanks_stay_dry(void **state)
{
    (void)state;
    Exercise     *e = fresh();
    Landscape     land;
    Choices       choices;
    GroundContact contact;
    for (int n = 0; n < 4; n++) stand(e, tank, -40 * n, 0, 52, 5, 8);
    for (int n = 0; n < 3; n++) stand(e, ship, 1500, 400 * n, 40, 8, 8);
    stand(e, ship, 1900, 900, 70, 8, 8);      /* 30 m too high: outvoted and set on the water */
    stand(e, submarine, 1300, -300, 0, 4, 8); /* 40 m down */
    stand(e, submarine, 1300, -600, 40, 4, 8);
    stand(e, tank, 1500, 0, 46, 8, 8);     /* on the first ship's deck */
    stand(e, missile, 600, 0, 44, 40, 16); /* a sea skimmer */
    e->shot[0] = (Shot){.firing = e->track[0].id, .result = dis_result_ground_impact, .fire_s = 1, .detonation_s = 2};
    memcpy(e->shot[0].p_burst_ecef, e->track[5].point[0].p_ecef, sizeof e->shot[0].p_burst_ecef); /* in the water */
    e->survey.shot_count = 1;
    choose(&land, &contact, &choices, e, "auto");
    for (int t = 0; t < 7; t++) {
        CHECK_NEAR(off_m(&land, e, t), 0, 0.05);
        for (int n = 0; n < e->track[t].count; n++)
            CHECK((surface_under(&land, &e->track[t].point[n]) == SURFACE_WATER) == (t >= 4));
    }
    CHECK_NEAR(off_m(&land, e, 7), 30, 0.05);
    CHECK_NEAR(off_m(&land, e, 8), -40, 0.05);
    CHECK_NEAR(off_m(&land, e, 9), 0, 0.05);
    for (int n = 0; n < 8; n++) CHECK(surface_under(&land, &e->track[10].point[n]) == SURFACE_WATER);
    CHECK(says(&choices, "sea: flat at 40.0 m above the ellipsoid, where 6 ships or submarines were; a shore"));
    CHECK(says(&choices, "sea: 1 submarine is under water and cannot be seen"));
    CHECK(says(&choices, "fitted to 4 land entities"));
    CHECK(says(&choices, "1 entity does not fit it and is set onto it: 1:1:8 E8, sent 30.0 m above it"));
    for (int n = 0; n < 16; n++) { /* nothing hides the missile's way */
        double p_enu[3];
        enu_from_ecef(p_enu, &frame, e->track[11].point[n].p_ecef);
        CHECK(elevation_height(&land.elevation, p_enu[0], p_enu[1], NULL) < p_enu[2]);
    }
    landscape_destroy(&land);

    e = fresh(); /* submarines alone: they are somewhere under the sea's level, or say it */
    stand(e, submarine, 0, 0, -60, 4, 8);
    choose(&land, &contact, &choices, e, "auto");
    CHECK_NEAR(off_m(&land, e, 0), -60, 0.05);
    CHECK(says(&choices, "to the horizon, nothing is on land"));
    landscape_destroy(&land);
    stand(e, submarine, 500, 0, 33, 4, 8);
    choose(&land, &contact, &choices, e, "auto");
    CHECK_NEAR(off_m(&land, e, 1), 0, 0.05);
    landscape_destroy(&land);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(standing_entities_say_where_the_ground_is),
        cmocka_unit_test(a_helicopter_that_hangs_is_not_parked),
        cmocka_unit_test(a_misfit_is_set_onto_it_and_said),
        cmocka_unit_test(ships_float_and_tanks_stay_dry),
    };
    return cmocka_run_group_tests(tests, open_place, close_place);
}
