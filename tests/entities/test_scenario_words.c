/* The words that a scenario has for types: each names a shape of the catalog, and its type is of a whole category where
 * one has that shape; the catalog gives that type the same shape back. */
#include "tests/check.h"

#include "entities/exercise/cast_private.h"
#include "pitviper_table.h"

static const struct {
    const char *word, *type;
} words[] = {
    /* clang-format off */
        {"tank", "1.1.0.1.0.0.0"},
        {"carrier", "1.1.0.2.0.0.0"},
        {"carrier_wheeled", "1.1.225.2.5.0.0"},
        {"jeep", "1.1.0.6.0.0.0"},
        {"truck", "1.1.0.7.0.0.0"},
        {"carrier_cargo", "1.1.0.8.0.0.0"},
        {"howitzer", "1.1.0.4.0.0.0"},
        {"rocket_launcher", "1.1.225.4.1.0.0"},
        {"rocket_truck", "1.1.225.4.24.0.0"},
        {"semi_trailer", "1.1.0.19.0.0.0"},
        {"gun", "1.1.0.5.0.0.0"},
        {"motorcycle", "1.1.0.80.0.0.0"},
        {"truck_heavy", "1.1.225.7.19.0.0"},
        {"mortar", "1.1.0.10.0.0.0"},
        {"trailer", "1.1.0.14.0.0.0"},
        {"bulldozer", "1.1.0.18.0.0.0"},
        {"radar", "1.1.0.23.0.0.0"},
        {"locomotive", "1.1.0.24.0.0.0"},
        {"railcar", "1.1.0.25.0.0.0"},
        {"car", "1.1.0.27.0.0.0"},
        {"launcher", "1.1.0.28.0.0.0"},
        {"shelter", "1.1.0.29.0.0.0"},
        {"building", "1.1.0.30.0.0.0"},
        {"tent", "1.1.0.39.0.0.0"},
        {"robot", "1.1.0.50.0.0.0"},
        {"bus", "1.1.0.82.0.0.0"},
        {"aircraft", "1.2.0.1.0.0.0"},
        {"attack_plane", "1.2.225.2.4.0.0"},
        {"bomber", "1.2.0.3.0.0.0"},
        {"cargo_plane", "1.2.0.4.0.0.0"},
        {"cargo_jet", "1.2.225.4.2.0.0"},
        {"airliner_4", "1.2.0.7.0.0.0"},
        {"patrol_plane", "1.2.0.5.0.0.0"},
        {"airliner", "1.2.0.57.0.0.0"},
        {"helicopter", "1.2.0.20.0.0.0"},
        {"helicopter_light", "1.2.0.24.0.0.0"},
        {"helicopter_utility", "1.2.0.21.0.0.0"},
        {"helicopter_tandem", "1.2.0.23.0.0.0"},
        {"uav", "1.2.0.50.0.0.0"},
        {"quadcopter", "1.2.225.50.10.0.0"},
        {"light_plane", "1.2.0.80.0.0.0"},
        {"airship", "1.2.0.100.0.0.0"},
        {"aircraft_carrier", "1.3.0.1.0.0.0"},
        {"ship", "1.3.0.2.0.0.0"},
        {"boat", "1.3.0.7.0.0.0"},
        {"cargo_ship", "1.3.0.9.0.0.0"},
        {"tanker", "1.3.0.10.0.0.0"},
        {"rhib", "1.3.0.61.9.0.0"},
        {"submarine", "1.4.0.1.0.0.0"},
        {"torpedo", "1.4.0.8.0.0.0"},
        {"satellite", "1.5.0.0.0.0.0"},
        {"missile", "2.0.0.0.0.0.0"},
        {"missile_air", "2.1.0.1.0.0.0"},
        {"missile_cruise", "2.5.0.1.0.0.0"},
        {"bomb_guided", "2.9.0.1.0.0.0"},
        {"missile_ballistic", "2.10.0.2.0.0.0"},
        {"shell", "2.2.0.2.0.0.0"},
        {"bomb", "2.11.0.2.0.0.0"},
        {"mine", "2.0.0.3.0.0.0"},
        {"person", "3.0.0.0.0.0.0"},
        {"animal", "3.0.0.200.0.0.0"},
        {"none", "4.0.0.0.0.0.0"},
        {"net", "5.1.0.90.0.0.0"},
        {"wall", "5.1.0.91.0.0.0"},
        {"bridge", "5.1.0.5.0.0.0"},
        {"crates", "6.0.0.0.0.0.0"},
        {"decoy", "8.1.0.5.0.0.0"},
        {"corner_reflector", "8.3.0.5.0.0.0"},
        {"chaff", "8.0.0.1.0.0.0"},
        {"flare", "8.0.0.2.0.0.0"},
        {"buoy", "8.4.0.0.0.0.0"},
    /* clang-format on */
};

enum { word_count = sizeof words / sizeof *words };

/* The type of a vehicle of this word; of munitions, which fly by a shot alone, of a shot's. */
static bool resolves(DisEntityType *out, const char *word, bool munition)
{
    static Scenario scenario;
    char            path[text_file_size], text[512];
    Cast           *cast = NULL;
    snprintf(text, sizeof text,
             munition ? "vehicles:\n  - {name: A, id: 11, type: tank, route_m: [[0, 0]]}\n"
                        "  - {name: B, id: 12, type: tank, route_m: [[900, 0]]}\n"
                        "shots:\n  - {name: M, from: A 11, at: B 12, time_s: 1, type: %s}\n"
                      : "vehicles:\n  - {name: A, id: 11, type: %s, route_m: [[0, 0]]}\n",
             word);
    text_file(path, text);
    const Status read = scenario_read(&scenario, path);
    const bool   good = read == STATUS_OK && cast_create(&cast, &scenario) == STATUS_OK;
    remove(path);
    for (int k = 0; good && k < cast->entity_count; k++)
        if (!munition || cast->entity[k].type.kind == 2) *out = cast->entity[k].type;
    cast_destroy(cast);
    scenario_destroy(&scenario);
    return good;
}

static void words_are_of_whole_categories(void **state)
{
    Catalog *catalog;
    char     path[4096];
    (void)state;
    CHECK(etc_path(path, sizeof path, "catalog.csv") && catalog_open(&catalog, path, 0.1) == STATUS_OK);
    for (int k = 0; k < word_count; k++) {
        DisEntityType type = {0};
        char          text[64];
        if (!resolves(&type, words[k].word, words[k].type[0] == '2')) fail_msg("%s is no type", words[k].word);
        snprintf(text, sizeof text, "%u.%u.%u.%u.%u.%u.%u", type.kind, type.domain, type.country, type.category,
                 type.subcategory, type.specific, type.extra);
        assert_string_equal(text, words[k].type);
        const Model *model = catalog_model(catalog, catalog_find(catalog, type, NULL, NULL));
        if (strncmp(model->name, words[k].word, strlen(words[k].word)) != 0)
            fail_msg("%s is seen as %s", words[k].word, model->name);
        if (!strcmp(words[k].word, "truck")) CHECK_NEAR(model->length_m, 7.4, 0.2); /* Ural-4320 */
    }
    catalog_close(catalog);
}

/* Each shape of the table is one of them. */
static void no_word_is_missing(void **state)
{
    char  path[4096];
    Table t;
    (void)state;
    CHECK(etc_path(path, sizeof path, "catalog.csv"));
    assert_int_equal(table_open(&t, path), STATUS_OK);
    for (int row = 1; row < t.rows; row++) {
        bool met = false;
        for (int k = 0; k < word_count; k++) met |= !strcmp(table_text(&t, row, 1), words[k].word);
        if (!met) fail_msg("%s has no word here", table_text(&t, row, 1));
    }
    table_close(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(words_are_of_whole_categories),
                                       cmocka_unit_test(no_word_is_missing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
