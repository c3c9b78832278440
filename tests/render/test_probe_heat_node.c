/* tests/render/test_probe_heat_node.c: `probe heat-node`, through the CSV that a user gives: its rows stand alone,
 * its ground is that of `probe heat-ground`, sun and engine warm what they should. labels: physics slow */
#include "tests/check.h"

#include "render/probe.h"

enum { most_rows = 16, most_octets = 1 << 14 };

/* A clear day at 48 N 11 E: the last `results` numbers of each row before its reason, its last cell. */
static int asked(double value[most_rows][8], char reason[most_rows][96], char *name, int results, const char *csv)
{
    static char  text[most_octets];
    char         day[] = "clear", lat[] = "48", lon[] = "11", *argv[] = {name, day, lat, lon, NULL};
    char        *cell[32], *line, *rest = text;
    const Probe *probe = NULL;
    for (int i = 0; i < render_probe_count; i++)
        if (strcmp(render_probes[i].name, name) == 0) probe = &render_probes[i];
    memset(text, 0, sizeof text);
    FILE *in = fmemopen((void *)(uintptr_t)csv, strlen(csv), "r"), *out = fmemopen(text, sizeof text - 1, "w");
    CHECK(probe && in && out && probe_run(probe, 4, argv, in, out) == STATUS_OK);
    fclose(in);
    fclose(out);
    int rows = 0;
    strtok_r(rest, "\n", &rest);
    for (; (line = strtok_r(NULL, "\n", &rest)); rows++) {
        const int cells = text_split(cell, 32, line);
        CHECK(rows < most_rows && cells > results);
        for (int c = 0; c < results; c++) {
            const char *at = cell[cells - 1 - results + c];
            if (!*at || !text_to_double(&value[rows][c], at)) value[rows][c] = NAN;
        }
        snprintf(reason[rows], 96, "%s", cell[cells - 1]);
    }
    return rows;
}

static char node[] = "heat-node", ground[] = "heat-ground";
enum { temp_k, low_k, high_k, air_k, ground_k, node_results };

/* And its ground and air are those of `probe heat-ground`. */
static void rows_stand_alone(void **state)
{
    (void)state;
    static double got[most_rows][8], want[most_rows][8];
    static char   reason[most_rows][96];
    CHECK(asked(got, reason, node, node_results,
                "unix_s,model,part\n1782036000,truck,\n1782122400,truck,\n1782036000,jeep,\n"
                "1782025200,truck,\n1782036000,truck,\n1782075600,truck,\n") == 6);
    CHECK(memcmp(got[0], got[4], sizeof got[0]) == 0);
    CHECK(fabs(got[0][temp_k] - got[1][temp_k]) < 0.5); /* a day later */
    CHECK(got[0][temp_k] != got[2][temp_k] && got[0][temp_k] != got[3][temp_k]);
    for (int r = 0; r < 6; r++) CHECK(got[r][low_k] <= got[r][temp_k] && got[r][temp_k] <= got[r][high_k]);
    CHECK(asked(want, reason, ground, 8, "unix_s,surface\n1782036000,grass\n1782075600,grass\n") == 2);
    for (int r = 0; r < 2; r++) {
        CHECK_NEAR(got[r ? 5 : 0][ground_k], want[r][0], 1e-6);
        CHECK_NEAR(got[r ? 5 : 0][air_k], want[r][1], 1e-6);
    }
}

/* 07:44 of the local sun; the truck's sides face east and west by turns. */
static void sun_and_engine_warm(void **state)
{
    (void)state;
    static double got[most_rows][8];
    static char   reason[most_rows][96];
    CHECK(asked(got, reason, node, node_results,
                "unix_s,model,part,heading_deg,engine,speed_mps\n1782025200,truck,canvas,0,,\n"
                "1782025200,truck,canvas,180,,\n"
                "1782000000,tank,engine_deck,,0,\n1782000000,tank,engine_deck,,1,\n1782000000,tank,exhaust,,1,\n"
                "1782000000,tank,track_left,,1,10\n1782000000,tank,track_left,,1,0\n") == 7);
    CHECK(got[0][high_k] - got[0][low_k] > 8);
    CHECK_NEAR(got[0][temp_k], got[1][temp_k], 0.5);
    CHECK(got[3][temp_k] > got[2][temp_k] + 10);
    CHECK(got[4][temp_k] > 400);
    CHECK(got[5][temp_k] > got[6][temp_k] + 5);
    CHECK(got[2][high_k] < got[2][air_k] + 5); /* at night, its engine stopped */
}

static void bad_rows_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *row, *why;
    } bad[] = {
        {"1782043200,nix,,,,", "no such model"},    {"1782043200,truck,wing,,,", "no part of this name"},
        {"1782043200,truck,,900,,", "heading_deg"}, {"1782043200,truck,,,1.5,", "engine"},
        {"1782043200,truck,,,,-1", "speed_mps"},    {"1e12,truck,,,,", "unix_s"},
    };
    enum { count = sizeof bad / sizeof *bad };
    static char   csv[most_octets], reason[most_rows][96];
    static double got[most_rows][8];
    char         *at = csv + sprintf(csv, "unix_s,model,part,heading_deg,engine,speed_mps\n");
    for (int i = 0; i < count; i++) at += sprintf(at, "%s\n", bad[i].row);
    CHECK(asked(got, reason, node, node_results, csv) == count);
    for (int i = 0; i < count; i++) {
        if (!strstr(reason[i], bad[i].why)) fail_msg("%s: %s", bad[i].row, reason[i]);
        for (int c = 0; c < node_results; c++) CHECK(isnan(got[i][c]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_stand_alone),
        cmocka_unit_test(sun_and_engine_warm),
        cmocka_unit_test(bad_rows_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
