/* tests/sensor/test_cigi_drawn.c: a CIGI host's entities in the entity table: who is there, where and how fast, by hand
 * on the equator; and the table of types. As seen: tests/system/test_cigi_entities.sh. */
#include "tests/check.h"

#include "sensor/node/cigi/cigi_drawn.h"

static CigiScene    scene;
static CigiDrawn    drawn;
static EntityTable *table;

static void begin(void)
{
    static Catalog         *catalog;
    const EntityTableConfig config = entity_table_default_config();
    memset(&scene, 0, sizeof scene);
    memset(&drawn, 0, sizeof drawn);
    if (!catalog) CHECK(catalog_open(&catalog, "etc/catalog.csv", 0.05) == STATUS_OK);
    CHECK(entity_table_create(&table, &config, catalog) == STATUS_OK);
    CHECK(cigi_types_read(&drawn.types, "") == STATUS_OK);
    drawn.site = 7, drawn.application = 8;
}

static void say(uint16_t id, uint16_t type, uint8_t state, double lat_deg)
{
    const CigiPacket packet = {
        .id = cigi_entity_control,
        .of.entity_control = {.id = id, .type = type, .state = state, .p = {lat_deg, 0, 0}, .yaw_deg = 90}};
    CHECK(cigi_scene_take(&scene, &packet));
}

static bool there(SnapshotEntity *out, uint16_t id, double t_s)
{
    return entity_table_pose(out, table, entity_table_find(table, (DisEntityId){7, 8, id}), t_s);
}

static void show(double t_s) { CHECK(cigi_drawn_show(&drawn, table, &scene, 0, t_s) == STATUS_OK); }

static void they_come_and_go(void **state)
{
    (void)state;
    SnapshotEntity e;
    begin();
    say(0, 1, cigi_entity_active, 0);     /* carries the eye */
    say(5, 1, cigi_entity_active, 1);     /* a tank */
    say(6, 0, cigi_entity_active, 1);     /* of no type */
    say(7, 60000, cigi_entity_active, 1); /* of none that is known */
    say(8, 6, cigi_entity_standby, 1);
    say(65535, 1, cigi_entity_active, 1); /* DIS has no such number */
    for (int k = 0; k < 3; k++) show(10 + k);
    CHECK(entity_table_count(table) == 1 && there(&e, 5, 12));
    CHECK(drawn.unmapped == 2); /* each once */
    DisEntityType type;
    CHECK(entity_table_type(&type, table, entity_table_find(table, (DisEntityId){7, 8, 5})));
    CHECK(type.kind == 1 && type.domain == 1 && type.country == 222 && type.category == 1);
    say(8, 6, cigi_entity_active, 1);
    say(5, 1, cigi_entity_standby, 1);
    show(13);
    CHECK(entity_table_count(table) == 1 && there(&e, 8, 13) && !there(&e, 5, 13));
    say(5, 1, cigi_entity_active, 1);
    say(8, 6, cigi_entity_destroyed, 1);
    show(14);
    CHECK(entity_table_count(table) == 1 && there(&e, 5, 14) && drawn.count == 1);
    entity_table_destroy(table);
}

/* A degree of latitude at the equator: its meridian is a circle of radius a (1 - e2) there. */
static void how_fast_they_are(void **state)
{
    (void)state;
    static const double step_deg = 1e-5, m_per_deg = 6378137 * (1 - 0.00669437999014) * rad_per_deg;
    SnapshotEntity      e;
    begin();
    say(5, 1, cigi_entity_active, 0);
    show(10);
    CHECK(there(&e, 5, 10) && v3_length(e.v_ecef_mps) == 0);
    say(5, 1, cigi_entity_active, step_deg);
    show(10.1);
    CHECK(there(&e, 5, 10.1));
    CHECK_NEAR(e.v_ecef_mps[2], step_deg * m_per_deg / 0.1, 1e-4);
    CHECK_NEAR(e.p_ecef[2], step_deg * m_per_deg, 1e-6);
    show(10.1); /* the same frame again */
    CHECK(there(&e, 5, 10.1));
    CHECK_NEAR(e.v_ecef_mps[2], step_deg * m_per_deg / 0.1, 1e-4);
    say(5, 1, cigi_entity_active, 2 * step_deg);
    show(11.2); /* too long after */
    CHECK(there(&e, 5, 11.2) && v3_length(e.v_ecef_mps) == 0);
    const CigiPacket rate = {.id = cigi_rate_control,
                             .of.rate_control = {.entity = 5, .local = true, .v_mps = {20}, .yaw_deg_s = 9}};
    CHECK(cigi_scene_take(&scene, &rate));
    show(11.3);
    CHECK(there(&e, 5, 11.3));
    CHECK_NEAR(e.v_ecef_mps[1], 20, 1e-5); /* it looks east */
    CHECK(there(&e, 5, 12.3));             /* turned by 9 degrees since, to the right: south */
    CHECK_NEAR(e.r_ecef_from_body[3], cos(9 * rad_per_deg), 1e-5);
    CHECK_NEAR(e.r_ecef_from_body[6], -sin(9 * rad_per_deg), 1e-5);
    entity_table_destroy(table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(they_come_and_go), cmocka_unit_test(how_fast_they_are)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
