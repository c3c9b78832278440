/* What attributes of files mean: lengths, numbers and directions as people write them, lists of pairs, tags of
 * OpenStreetMap and names of others, against values worked out by hand. labels: small */
#include "tests/check.h"

#include "terrain/from_files/culture_import_private.h"

#include <float.h>

/* ---- texts ------------------------------------------------------------------------------------------- */

static void lengths(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double      m; /* NAN: none */
    } some[] = {{"12", 12},
                {"12 m", 12},
                {"12m", 12},
                {"12.5", 12.5},
                {"3,5", 3.5},
                {" 7 metres ", 7},
                {"39 ft", 11.8872},
                {"39'6\"", 12.0396},
                {"39' 6\"", 12.0396},
                {"39'", 11.8872},
                {"5 ft 6 in", 1.6764},
                {"120 cm", 1.2},
                {"6\"", 0.1524},
                {"~12", 12},
                {"12.", 12},
                {"1.2e1", 12},
                {"0", 0},
                {"-3", -3},
                {"9999", 9999},
                {"100 feet", 30.48},
                {"0.5 km", 500},
                {"12 M", 12},
                {"5'11''", 1.8034},
                {"", NAN},
                {"tall", NAN},
                {"12-14", NAN},
                {"10;12", NAN},
                {"m", NAN},
                {"12 bananas", NAN},
                {"1e999", NAN},
                {"nan", NAN},
                {"inf", NAN},
                {"0x12", NAN},
                {"39'6'", NAN},
                {"5 ft 6 m", NAN},
                {"--3", NAN},
                {"3,5,7", NAN},
                {"1e", NAN}};
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        double     m = 77;
        const bool got = culture_metres(&m, some[k].text);
        if (got != !isnan(some[k].m)) fail_msg("'%s': %d", some[k].text, got);
        if (got) CHECK_NEAR(m, some[k].m, 1e-9);
        else CHECK(m == 77);
    }
}

static void numbers_and_directions(void **state)
{
    (void)state;
    double x;
    CHECK(culture_number(&x, "2") && x == 2);
    CHECK(culture_number(&x, "2,5") && fabs(x - 2.5) < 1e-12);
    CHECK(culture_number(&x, "3;4") && x == 3);
    CHECK(!culture_number(&x, "two") && !culture_number(&x, "3 m") && !culture_number(&x, ""));
    static const struct {
        const char *text;
        double      deg;
    } some[] = {{"135", 135}, {"NW", 315}, {"n", 0},     {"SSE", 157.5}, {"west", 270},  {"90\xc2\xb0", 90},
                {"-90", 270}, {"up", NAN}, {"400", NAN}, {"", NAN},      {"12 deg", NAN}};
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        const bool got = culture_direction(&x, some[k].text);
        if (got != !isnan(some[k].deg)) fail_msg("'%s': %d", some[k].text, got);
        if (got) CHECK_NEAR(x, some[k].deg * pi_rad / 180, 1e-12);
    }
}

static void pairs(void **state)
{
    (void)state;
    char        name[culture_text_size], value[culture_text_size];
    const char *at = "\"height\"=>\"12 m\",\"name\"=>\"a \\\"b\\\", c\", \"empty\"=>\"\"";
    CHECK(culture_pair(name, value, &at) && strcmp(name, "height") == 0 && strcmp(value, "12 m") == 0);
    CHECK(culture_pair(name, value, &at) && strcmp(name, "name") == 0 && strcmp(value, "a \"b\", c") == 0);
    CHECK(culture_pair(name, value, &at) && strcmp(name, "empty") == 0 && *value == 0);
    CHECK(!culture_pair(name, value, &at));
    at = "{ \"building\": \"yes\", \"height\": 12.5 , \"levels\":3}";
    CHECK(culture_pair(name, value, &at) && strcmp(name, "building") == 0 && strcmp(value, "yes") == 0);
    CHECK(culture_pair(name, value, &at) && strcmp(value, "12.5") == 0);
    CHECK(culture_pair(name, value, &at) && strcmp(name, "levels") == 0 && strcmp(value, "3") == 0);
    CHECK(!culture_pair(name, value, &at));
    static const char *const bad[] = {"", "x", "\"open", "\"a\"", "\"a\"=>\"open", "\"a\"-\"b\"", "{}"};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        at = bad[k];
        CHECK(!culture_pair(name, value, &at));
    }
    char text[2000] = "\"";
    memset(text + 1, 'k', 900);
    strcpy(text + 901, "\"=>\"v\"");
    at = text;
    CHECK(culture_pair(name, value, &at) && strlen(name) == culture_text_size - 1 && strcmp(value, "v") == 0);
}

/* ---- features ---------------------------------------------------------------------------------------- */

static CultureRules rules;

static int open_rules(void **state)
{
    (void)state;
    return culture_rules_open(&rules, NULL) != STATUS_OK;
}

static int close_rules(void **state)
{
    (void)state;
    culture_rules_close(&rules);
    return 0;
}

/* The facts of "key=value|key=value". */
static CultureFacts facts_of(const char *tags)
{
    static char  copy[1024];
    const char  *name[16], *value[16];
    int          count = 0;
    CultureFacts f;
    snprintf(copy, sizeof copy, "%s", tags);
    for (char *at = copy; *at && count < 16;) {
        char *end = at + strcspn(at, "|"), *next = *end ? end + 1 : end, *equals = at + strcspn(at, "=");
        *end = *equals = 0;
        name[count] = at, value[count++] = equals + 1;
        at = next;
    }
    culture_facts(&f, &rules, count, name, value);
    return f;
}

static void what_a_feature_is(void **state)
{
    (void)state;
    static const struct {
        const char *tags;
        VectorShape shape;
        int         makes, kind, surface; /* makes -1: nothing */
        double      width_m;
    } some[] = {
        {"building=yes", VECTOR_POLYGON, MAKES_BUILDING, -1, 0, 0},
        {"BUILDING=Apartments", VECTOR_POLYGON, MAKES_BUILDING, BUILDING_FLATS, 0, 0},
        {"building=no", VECTOR_POLYGON, -1, 0, 0, 0},
        {"building=yes", VECTOR_LINE, -1, 0, 0, 0},
        {"building=roof", VECTOR_POLYGON, -1, 0, 0, 0},
        {"building:part=yes|height=9", VECTOR_POLYGON, -1, 0, 0, 0},
        {"building=yes|man_made=silo", VECTOR_POLYGON, MAKES_POINT, CULTURE_SILO, 0, 6},
        {"man_made=storage_tank", VECTOR_POINT, MAKES_POINT, CULTURE_TANK, 0, 14},
        {"man_made=chimney", VECTOR_POINT, MAKES_POINT, CULTURE_CHIMNEY, 0, 3},
        {"man_made=mast", VECTOR_POINT, MAKES_POINT, CULTURE_MAST, 0, 2},
        {"power=pole", VECTOR_POINT, MAKES_POINT, CULTURE_POLE, 0, 0.3},
        {"power=line", VECTOR_LINE, MAKES_LINE, CULTURE_POWER_LINE, 0, 0.1},
        {"barrier=wall", VECTOR_LINE, MAKES_LINE, CULTURE_WALL, 0, 0.3},
        {"barrier=fence", VECTOR_POLYGON, MAKES_LINE, CULTURE_FENCE, 0, 0.1},
        {"barrier=hedge", VECTOR_LINE, MAKES_TREE_ROW, PLANT_HEDGE, 0, 1.2},
        {"highway=primary", VECTOR_LINE, MAKES_LINE, CULTURE_ROAD, SURFACE_ROAD, 8},
        {"highway=track", VECTOR_LINE, MAKES_LINE, CULTURE_TRACK, SURFACE_TRACK, 3},
        {"highway=primary|area=yes", VECTOR_POLYGON, -1, 0, 0, 0},
        {"highway=proposed", VECTOR_LINE, -1, 0, 0, 0},
        {"waterway=river", VECTOR_LINE, MAKES_LINE, CULTURE_WATER, SURFACE_WATER, 15},
        {"natural=tree", VECTOR_POINT, MAKES_TREE, -1, 0, 0},
        {"natural=water", VECTOR_POLYGON, -1, 0, 0, 0},
        {"landuse=forest", VECTOR_POLYGON, -1, 0, 0, 0},
        {"fclass=building|type=garage|code=1500", VECTOR_POLYGON, MAKES_BUILDING, -1, 0, 0},
        {"fclass=secondary|code=5114", VECTOR_LINE, MAKES_LINE, CULTURE_ROAD, SURFACE_ROAD, 7},
        {"code=5113", VECTOR_LINE, MAKES_LINE, CULTURE_ROAD, SURFACE_ROAD, 8},
        {"fclass=forest", VECTOR_POLYGON, -1, 0, 0, 0},
        {"other_tags=\"power\"=>\"pole\",\"height\"=>\"11\"", VECTOR_POINT, MAKES_POINT, CULTURE_POLE, 0, 0.3},
        {"tags={\"highway\": \"service\"}", VECTOR_LINE, MAKES_LINE, CULTURE_ROAD, SURFACE_ROAD, 3.5},
    };
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        const CultureFacts f = facts_of(some[k].tags);
        const CultureRule *r = f.what[some[k].shape];
        if ((r ? r->makes : -1) != some[k].makes) fail_msg("%s: makes %d", some[k].tags, r ? r->makes : -1);
        CHECK(f.known);
        if (!r) continue;
        if (r->kind != some[k].kind || r->surface != some[k].surface) fail_msg("%s: kind %d", some[k].tags, r->kind);
        CHECK_NEAR(r->width_m, some[k].width_m, 1e-9);
    }
    CHECK(!facts_of("name=x|height=12").known && !facts_of("").known);
}

static void what_a_feature_says(void **state)
{
    (void)state;
    CultureFacts f =
        facts_of("building=church|height=39 ft|roof:height=2|roof:levels=1|building:levels=3|min_height=low");
    CHECK_NEAR(f.height_m, 11.8872, 1e-9);
    CHECK(f.roof_height_m == 2 && f.roof_levels == 1 && f.levels == 3 && f.unread == 0);
    f = facts_of("amenity=place_of_worship|building=yes|roof:shape=Mansard|roof:orientation=across|roof:material=slate|"
                 "building:material=sandstone|roof:direction=SW");
    CHECK(f.use == BUILDING_CHURCH && f.roof == ROOF_HIPPED && f.roof_way == 1 && f.cover == FABRIC_SLATE &&
          f.wall == FABRIC_STONE);
    CHECK_NEAR(f.direction_rad, 225 * rad_per_deg, 1e-12);
    static const char *const heights[] = {"height", "HEIGHT", "hoehe", "measuredHeight", "bldg_height", "measuredHe"};
    for (size_t k = 0; k < sizeof heights / sizeof *heights; k++) {
        char text[64];
        snprintf(text, sizeof text, "%s=7,5", heights[k]);
        CHECK_NEAR(facts_of(text).height_m, 7.5, 1e-9);
    }
    /* as Shapefiles cut them, with and without their colons */
    f = facts_of("building_l=4|roof:heigh=3|roof_shape=gabled|building:m=brick|roof_mater=thatch");
    CHECK(f.levels == 4 && f.roof_height_m == 3 && f.roof == ROOF_GABLED && f.wall == FABRIC_BRICK &&
          f.cover == FABRIC_THATCH);
    CHECK(facts_of("levels=2").levels == 2 && facts_of("floors=5").levels == 5);
    f = facts_of("highway=residential|width=4.5|lanes=2|surface=gravel|bridge=yes|tunnel=F|osm_id=77");
    CHECK(f.width_m == 4.5 && f.lanes == 2 && f.ground == SURFACE_TRACK && f.bridge && !f.hidden && f.id != 0);
    CHECK(facts_of("tunnel=culvert").hidden && facts_of("location=underground").hidden &&
          !facts_of("bridge=no").bridge);
    f = facts_of("natural=tree|leaf_type=needleleaved|marked=yes");
    CHECK(f.plant == PLANT_PINE && f.mark == MARK_WHITE);
    CHECK(facts_of("natural=tree|species=Quercus rubra").plant == PLANT_RED_OAK);
    f = facts_of("building=yes|height=tall|building:levels=many");
    CHECK(isnan(f.height_m) && isnan(f.levels) && f.unread == 2);
    f = facts_of("building=ruins");
    CHECK(f.ruined && f.what[VECTOR_POLYGON]);
    /* a list within a list is not opened */
    f = facts_of("other_tags=\"other_tags\"=>\"\\\"height\\\"=>\\\"5\\\"\"");
    CHECK(isnan(f.height_m));
}

/* ---- buildings --------------------------------------------------------------------------------------- */

static Building building_of(const char *tags, double length_m, double width_m, HeightFrom *from, int *mended)
{
    const double       turned = 0.4, c = cos(turned), s = sin(turned);
    const double       p[4][2] = {{0, 0},
                                  {length_m * c, length_m * s},
                                  {length_m * c - width_m * s, length_m * s + width_m * c},
                                  {-width_m * s, width_m * c}};
    const CultureFacts f = facts_of(tags);
    Building           b;
    *mended = 0;
    culture_building_make(&b, from, mended, &f, p, 4, length_m * width_m, false);
    return b;
}

static void heights_by_what_is_said(void **state)
{
    (void)state;
    static const struct {
        const char *tags;
        double      eaves_m, ridge_m;
        HeightFrom  from;
        int         mended;
    } some[] = {
        /* 12 x 10 m: a slope of 0.84 over half of 10 m rises 4.2 m */
        {"building=house|height=10", 5.8, 10, HEIGHT_FROM_FILE, 0},
        {"building=house|height=10|roof:shape=flat", 10, 10, HEIGHT_FROM_FILE, 0},
        {"building=house|height=10|roof:height=3", 7, 10, HEIGHT_FROM_FILE, 0},
        {"building=house|height=3", 1.8, 3, HEIGHT_FROM_FILE, 0}, /* walls keep 1.8 m */
        {"building=house|height=6|roof:height=6", 3, 6, HEIGHT_FROM_FILE, 0},
        {"building=house|building:levels=2", 6, 10.2, HEIGHT_FROM_LEVELS, 0},
        {"building=house|building:levels=2|roof:levels=1", 6, 8.7, HEIGHT_FROM_LEVELS, 0},
        {"building=house|building:levels=2|roof:shape=skillion", 6, 7.8, HEIGHT_FROM_LEVELS, 0}, /* 0.18 x 10 */
        {"building=house", 6, 10.2, HEIGHT_FROM_USE, 0},
        {"building=garage", 2.4, 6.6, HEIGHT_FROM_USE, 0},
        {"building=warehouse", 7, 7, HEIGHT_FROM_USE, 0},
        {"building=house|height=9999", 6, 10.2, HEIGHT_FROM_USE, 1},
        {"building=house|height=-4|building:levels=2", 6, 10.2, HEIGHT_FROM_LEVELS, 1},
        {"building=house|height=9999|building:levels=5000|roof:height=900", 6, 10.2, HEIGHT_FROM_USE, 3},
        {"building=house|height=0", 6, 10.2, HEIGHT_FROM_USE, 0}, /* not known */
        {"building=yes|height=850", 845.8, 850, HEIGHT_FROM_FILE, 0},
        {"height=8", 4, 8, HEIGHT_FROM_FILE, 0}, /* half is the walls' */
    };
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        HeightFrom     from;
        int            mended;
        const Building b = building_of(some[k].tags, 12, 10, &from, &mended);
        if (!(fabs((double)b.eaves_m - some[k].eaves_m) < 1e-4 && fabs((double)b.ridge_m - some[k].ridge_m) < 1e-4))
            fail_msg("%s: %.4f, %.4f", some[k].tags, (double)b.eaves_m, (double)b.ridge_m);
        if (from != some[k].from || mended != some[k].mended) fail_msg("%s: from %d, %d", some[k].tags, from, mended);
    }
}

static void use_roof_and_fabrics(void **state)
{
    (void)state;
    HeightFrom from;
    int        mended;
    static const struct {
        const char *tags;
        double      length_m, width_m;
        int         use, roof, levels;
    } some[] = {{"building=yes", 5, 4, BUILDING_SHED, ROOF_FLAT, 1},
                {"building=yes", 12, 10, BUILDING_HOUSE, ROOF_GABLED, 2},
                {"building=yes", 30, 20, BUILDING_FLATS, ROOF_HIPPED, 3},
                {"building=yes", 80, 40, BUILDING_HALL, ROOF_FLAT, 2},
                {"building=yes|building:levels=9", 12, 10, BUILDING_FLATS, ROOF_FLAT, 9},
                {"building=barn", 30, 12, BUILDING_BARN, ROOF_GABLED, 1},
                {"amenity=place_of_worship|building=yes", 30, 12, BUILDING_CHURCH, ROOF_GABLED, 3},
                {"fclass=building|type=garage", 12, 10, BUILDING_SHED, ROOF_GABLED, 1},
                {"building=yes|roof:shape=dome", 12, 10, BUILDING_HOUSE, ROOF_PYRAMIDAL, 2}};
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        const Building b = building_of(some[k].tags, some[k].length_m, some[k].width_m, &from, &mended);
        if (b.use != some[k].use || b.roof != some[k].roof || b.levels != some[k].levels)
            fail_msg("%s: %d %d %d", some[k].tags, b.use, b.roof, b.levels);
        CHECK(b.heated == (b.use == BUILDING_HOUSE || b.use == BUILDING_FLATS));
    }
    Building b = building_of("building=house|roof:material=thatch|building:material=brick", 12, 10, &from, &mended);
    CHECK(b.roof_fabric == FABRIC_THATCH && b.wall_fabric == FABRIC_BRICK && b.chimneys == 1);
    b = building_of("building=ruins", 12, 10, &from, &mended);
    CHECK(b.damage == 2 && !b.heated);
    /* ridges: along the longer side, turned by 0.4; across; by the way that a slope faces, which is across the ridge */
    static const struct {
        const char *tags;
        double      length_m, rad;
    } ridges[] = {{"building=house", 12, 0.4},
                  {"building=house", 8, 0.4 + pi_rad / 2}, /* 8 x 10: the other side is longer */
                  {"building=house|roof:orientation=across", 12, 0.4 + pi_rad / 2},
                  {"building=house|roof:direction=0", 12, 0},
                  {"building=house|roof:direction=E", 12, pi_rad / 2},
                  {"building=house|roof:shape=skillion|roof:direction=E", 12, 0}};
    for (size_t k = 0; k < sizeof ridges / sizeof *ridges; k++) {
        b = building_of(ridges[k].tags, ridges[k].length_m, 10, &from, &mended);
        CHECK_NEAR(sin((double)b.ridge_rad - ridges[k].rad), 0, 1e-6);
        if (b.roof == ROOF_SKILLION) CHECK_NEAR(cos((double)b.ridge_rad - ridges[k].rad), 1, 1e-6);
    }
}

/* Of a turned rectangle with a notch in it: the rectangle. */
static void rectangles(void **state)
{
    (void)state;
    double side_m[2], along;
    for (int k = 0; k < 40; k++) {
        const double a = k * 0.17, c = cos(a), s = sin(a), u[6] = {0, 30, 30, 18, 18, 0}, v[6] = {0, 0, 9, 9, 14, 14};
        double       p[6][2];
        for (int n = 0; n < 6; n++) p[n][0] = 5e3 + c * u[n] - s * v[n], p[n][1] = -7e3 + s * u[n] + c * v[n];
        culture_rectangle(side_m, &along, (const double(*)[2])p, 6);
        CHECK_NEAR(side_m[0], 30, 1e-6);
        CHECK_NEAR(side_m[1], 14, 1e-6);
        CHECK_NEAR(sin(along - a), 0, 1e-9);
        CHECK(along > -1e-8 && along < pi_rad);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths),
        cmocka_unit_test(numbers_and_directions),
        cmocka_unit_test(pairs),
        cmocka_unit_test_setup_teardown(what_a_feature_is, open_rules, close_rules),
        cmocka_unit_test_setup_teardown(what_a_feature_says, open_rules, close_rules),
        cmocka_unit_test_setup_teardown(heights_by_what_is_said, open_rules, close_rules),
        cmocka_unit_test_setup_teardown(use_roof_and_fabrics, open_rules, close_rules),
        cmocka_unit_test(rectangles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
