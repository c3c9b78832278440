/* tests/entities/test_catalog.c: which row wins, and what a bad table says. */
#include "tests/check.h"
#include "entities/catalog/catalog.h"

static char last_error[512];

static void keep_error(void *user, LogLevel level, const char *line)
{
    (void)user;
    if (level == LOG_ERROR) snprintf(last_error, sizeof last_error, "%s", line);
}

/* Opens a catalog of the given text; on success the caller closes it. */
static Status open_text(Catalog **catalog, const char *text)
{
    char path[text_file_size];
    text_file(path, text);
    last_error[0] = 0;
    log_set_sink(keep_error, NULL);
    const Status status = catalog_open(catalog, path, 0.02);
    log_set_sink(NULL, NULL);
    remove(path);
    return status;
}

static const char *found(const Catalog *catalog, DisEntityType type)
{
    return catalog_model(catalog, catalog_find(catalog, type, NULL, NULL))->name;
}

static void deepest_named_row_wins(void **state)
{
    (void)state;
    Catalog *c;
    Origin   origin;
    int      matched;
    CHECK(open_text(&c, "type,model,origin\n"
                        "1.1.222.*.*.*.*,helicopter,base\n"
                        "1.1.*.1.*.*.*,tank,base\n"      /* deeper than the country alone */
                        "1.1.222.1.*.*.*,truck,base\n"   /* as deep, one star fewer */
                        "1.1.222.1.*.*.*,missile,base\n" /* equal: the earlier wins */
                        "1.1.*.*.*.*.9,missile,centre\n" /* deepest of all */
                        "2,missile,centre\n") == STATUS_OK);
    CHECK(strcmp(found(c, (DisEntityType){1, 1, 222, 1, 0, 0, 0}), "truck") == 0);
    CHECK(strcmp(found(c, (DisEntityType){1, 1, 225, 1, 0, 0, 0}), "tank") == 0);
    CHECK(strcmp(found(c, (DisEntityType){1, 1, 222, 2, 0, 0, 0}), "helicopter") == 0);
    CHECK(catalog_find(c, (DisEntityType){1, 1, 222, 1, 1, 1, 9}, &origin, &matched) >= 0);
    CHECK(origin == ORIGIN_CENTRE && matched == 7);
    CHECK(strcmp(found(c, (DisEntityType){2, 200, 65535, 255, 255, 255, 255}), "missile") == 0);
    const int unknown = catalog_find(c, (DisEntityType){3, 1, 225, 1, 0, 0, 0}, &origin, &matched);
    CHECK(strcmp(catalog_model(c, unknown)->name, "unknown") == 0);
    CHECK(origin == ORIGIN_BASE && matched == 0);
    /* each model once: unknown, helicopter, tank, truck, missile */
    CHECK(catalog_model_count(c) == 5);
    catalog_close(c);
}

/* A row for everything covers nothing in particular, but it is a row. */
static void a_row_of_stars_matches_all(void **state)
{
    (void)state;
    Catalog *c;
    int      matched;
    CHECK(open_text(&c, "type,model,origin\n*.*.*.*.*.*.*,truck,centre\n1,tank,base\n") == STATUS_OK);
    CHECK(strcmp(found(c, (DisEntityType){1, 0, 0, 0, 0, 0, 0}), "tank") == 0);
    const int other = catalog_find(c, (DisEntityType){0}, NULL, &matched);
    CHECK(strcmp(catalog_model(c, other)->name, "truck") == 0 && matched == 0);
    catalog_close(c);
}

static void malformed_rows_are_named(void **state)
{
    (void)state;
    static const char *const bad_row[] = {
        "1.1.x.1,tank,base", "1.1.256.1.1.1.256,tank,base",
        "1..2,tank,base",    "1.1.1.1.1.1.1.1,tank,base",
        "-1,tank,base",      "1. 1,tank,base",
        "1.1.,tank,base",    "1.1.70000,tank,base",
        ",tank,base",        "1,tank,middle",
        "1,zeppelin,base",   "1.1.99999999,tank,base",
        "**,tank,base",
    };
    for (size_t i = 0; i < sizeof bad_row / sizeof *bad_row; i++) {
        char     text[256];
        Catalog *c = NULL;
        snprintf(text, sizeof text, "type,model,origin\n# comment\n1.1,tank,base\n%s\n", bad_row[i]);
        if (open_text(&c, text) != STATUS_BAD_VALUE) fail_msg("accepted: %s", bad_row[i]);
        CHECK(c == NULL);
        if (!strstr(last_error, ":4: column ") && !strstr(last_error, "line=4 model="))
            fail_msg("no line in: %s", last_error);
    }
    Catalog *c = NULL;
    CHECK(open_text(&c, "type,model\n1,tank\n") == STATUS_BAD_VALUE && strstr(last_error, "origin"));
    CHECK(catalog_open(&c, "/nonexistent/catalog.csv", 0.02) == STATUS_IO && c == NULL);
}

/* The table that is shipped: the types of recorded exercises get their shapes. */
/* Sorted once: a file with its deepest rows last takes no longer for it. Row by row it was minutes. */
static void many_rows_in_the_worst_order(void **state)
{
    (void)state;
    enum { rows = 300000 };
    char *text = malloc(rows * 24), *at = text;
    CHECK(text);
    at = stpcpy(at, "type,model,origin\n");
    for (int i = 0; i < rows; i++)
        at = stpcpy(at, i < rows / 2   ? "2,unknown,base\n"
                        : i < rows - 1 ? "2.1,unknown,base\n"
                                       : "2.2,marker,centre\n");
    Catalog     *catalog;
    const double begun_s = cpu_s();
    CHECK(open_text(&catalog, text) == STATUS_OK);
    CHECK(cpu_s() - begun_s < 20); /* 0.1 s here */
    assert_string_equal(found(catalog, (DisEntityType){.kind = 2, .domain = 2}), "marker");
    assert_string_equal(found(catalog, (DisEntityType){.kind = 2, .domain = 1}), "unknown");
    catalog_close(catalog);
    free(text);
}

static void shipped_table(void **state)
{
    (void)state;
    static const struct {
        DisEntityType type;
        const char   *model;
        Origin        origin;
    } want[] = {
        {{1, 1, 222, 1, 1, 1, 0}, "tank", ORIGIN_BASE},
        {{1, 1, 225, 2, 1, 0, 0}, "carrier", ORIGIN_BASE},
        {{1, 1, 222, 7, 1, 0, 0}, "truck", ORIGIN_BASE},
        {{1, 1, 222, 6, 1, 0, 0}, "jeep", ORIGIN_BASE},
        {{1, 1, 13, 82, 0, 0, 0}, "bus", ORIGIN_BASE},
        {{1, 2, 225, 20, 1, 0, 0}, "helicopter", ORIGIN_BASE},
        {{1, 2, 225, 23, 7, 0, 0}, "helicopter_tandem", ORIGIN_BASE},
        {{2, 2, 225, 1, 1, 3, 0}, "missile", ORIGIN_CENTRE},
        {{2, 9, 222, 2, 5, 0, 0}, "shell", ORIGIN_CENTRE},
        {{1, 2, 225, 1, 1, 0, 0}, "aircraft", ORIGIN_BASE},
        {{3, 1, 225, 1, 0, 0, 0}, "person", ORIGIN_BASE},
        {{0, 0, 0, 0, 0, 0, 0}, "unknown", ORIGIN_BASE},
        {{1, 1, 222, 28, 7, 1, 0}, "launcher", ORIGIN_BASE},
        {{1, 1, 222, 4, 1, 0, 0}, "howitzer", ORIGIN_BASE},
        {{1, 1, 222, 5, 1, 0, 0}, "gun", ORIGIN_BASE},
        {{1, 1, 222, 8, 1, 0, 0}, "carrier_cargo", ORIGIN_BASE},
        {{1, 2, 225, 4, 1, 0, 0}, "cargo_plane", ORIGIN_BASE},
        {{1, 2, 225, 26, 1, 0, 0}, "helicopter_light", ORIGIN_BASE},
        {{1, 2, 225, 91, 1, 0, 0}, "helicopter_light", ORIGIN_BASE},
        {{1, 3, 71, 50, 1, 0, 0}, "ship", ORIGIN_BASE},
        {{1, 4, 222, 3, 1, 0, 0}, "submarine", ORIGIN_BASE},
        {{1, 5, 225, 11, 0, 0, 0}, "satellite", ORIGIN_CENTRE},
        {{5, 1, 225, 11, 0, 0, 0}, "building", ORIGIN_BASE},
        {{8, 2, 225, 2, 0, 0, 0}, "flare", ORIGIN_CENTRE},
        {{8, 2, 225, 1, 0, 0, 0}, "chaff", ORIGIN_CENTRE},
        {{8, 1, 225, 5, 0, 0, 0}, "decoy", ORIGIN_BASE},
        {{8, 3, 225, 5, 0, 0, 0}, "corner_reflector", ORIGIN_BASE},
        {{8, 2, 225, 5, 0, 0, 0}, "none", ORIGIN_CENTRE},
        {{4, 1, 225, 0, 0, 0, 0}, "none", ORIGIN_BASE},
        {{6, 1, 225, 1, 0, 0, 0}, "crates", ORIGIN_BASE},
        {{7, 1, 225, 1, 0, 0, 0}, "none", ORIGIN_BASE},
        {{9, 1, 225, 1, 0, 0, 0}, "radar", ORIGIN_BASE},
        {{8, 4, 225, 6, 0, 0, 0}, "buoy", ORIGIN_BASE},
    };
    char     path[512];
    Catalog *c;
    CHECK(etc_path(path, sizeof path, "catalog.csv"));
    CHECK(catalog_open(&c, path, 0.02) == STATUS_OK);
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        Origin    origin;
        const int model = catalog_find(c, want[i].type, &origin, NULL);
        if (strcmp(catalog_model(c, model)->name, want[i].model) != 0 || origin != want[i].origin)
            fail_msg("row %zu: got %s, want %s", i, catalog_model(c, model)->name, want[i].model);
    }
    for (int m = 0; m < catalog_model_count(c); m++) CHECK(model_validate(catalog_model(c, m)) == STATUS_OK);
    catalog_close(c);
    catalog_close(NULL);
}

static void own_rows_go_before_the_tables(void **state)
{
    (void)state;
    Catalog       *c;
    Origin         origin;
    int            matched;
    char           own[text_file_size];
    CatalogRowInfo row;
    text_file(own, "type,model,origin,length_m,note\n1.1.222,truck,centre,9,ours\n");
    CHECK(etc_own_set("catalog.csv", own) && !etc_own_set("heat.csv", own));
    CHECK(open_text(&c, "type,model,origin\n1.1.222.1.1,tank,base\n1.1.225,helicopter,base\n") == STATUS_OK);
    CHECK(etc_own_set("catalog.csv", NULL) && !etc_own("catalog.csv"));
    remove(own);
    /* shallower than the table's own row, and taken all the same */
    const int model = catalog_find(c, (DisEntityType){1, 1, 222, 1, 1, 0, 0}, &origin, &matched);
    assert_string_equal(catalog_model(c, model)->name, "truck");
    CHECK(origin == ORIGIN_CENTRE && matched == 3);
    CHECK_NEAR(catalog_model(c, model)->length_m, 9, 0.01);
    double size_m[3];
    catalog_size(size_m, c, model);
    CHECK_NEAR(size_m[0], 9, 0.01);
    CHECK_NEAR(size_m[2], catalog_model(c, model)->height_m, 0.02);
    assert_string_equal(found(c, (DisEntityType){1, 1, 225, 1, 1, 0, 0}), "helicopter");
    CHECK(catalog_row_count(c) == 3);
    catalog_row(&row, c, 0);
    assert_string_equal(row.type, "1.1.222.*.*.*.*");
    assert_string_equal(row.note, "ours");
    CHECK(row.own && row.line == 2 && row.kind == 1 && row.domain == 1);
    catalog_close(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(own_rows_go_before_the_tables), cmocka_unit_test(deepest_named_row_wins),
        cmocka_unit_test(a_row_of_stars_matches_all),    cmocka_unit_test(malformed_rows_are_named),
        cmocka_unit_test(many_rows_in_the_worst_order),  cmocka_unit_test(shipped_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
