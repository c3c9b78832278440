/* Temperatures that the user gives: lines between rows, who wins, files that are refused. labels: physics */
#include "tests/check.h"

#include "render/heat/given_heat.h"

static ModelPart part[] = {{.name = "hull", .role = HEAT_HULL},
                           {.name = "deck", .role = HEAT_ENGINE_DECK},
                           {.name = "grille", .role = HEAT_ENGINE_DECK},
                           {.name = "exhaust", .role = HEAT_PASSIVE}};
static Model     tank = {.name = "tank", .part = part, .part_count = 4},
             truck = {.name = "truck", .part = part, .part_count = 4};
static const DisEntityId first = {1, 1, 1}, second = {1, 1, 2};

static Status open_text(GivenHeat **out, const char *text)
{
    char path[text_file_size];
    text_file(path, text);
    *out = NULL;
    const Status status = given_heat_open(out, path);
    remove(path);
    return status;
}

static double k_of(const GivenHeat *g, DisEntityId id, const Model *model, int p, double t_s)
{
    int       rank;
    const int index = given_heat_find(&rank, g, id, model, p);
    CHECK((index >= 0) == (rank >= 0));
    return index < 0 ? NAN : given_heat_k(g, index, t_s);
}

static void lines_between_rows(void **state)
{
    (void)state;
    GivenHeat *g;
    CHECK(
        open_text(
            &g,
            "# of a test\nentity,part,t_s,temp_k\ntank,hull,10,300\ntank,deck,0,1\ntank,hull,20,320\ntank,hull,40,310\n") ==
        STATUS_OK);
    static const double t_s[] = {-INFINITY, -5, 10, 12.5, 20, 30, 40, 1e12, INFINITY},
                        k[] = {300, 300, 300, 305, 320, 315, 310, 310, 310};
    for (int i = 0; i < 9; i++) CHECK_NEAR(k_of(g, first, &tank, 0, t_s[i]), k[i], 1e-12);
    CHECK(k_of(g, first, &tank, 0, NAN) == 300);
    CHECK(k_of(g, first, &tank, 1, 7) == 1);
    CHECK(isnan(k_of(g, first, &tank, 2, 7)) && isnan(k_of(g, first, &truck, 0, 7)));
    given_heat_close(g);
}

static void the_closest_name_wins(void **state)
{
    (void)state;
    GivenHeat *g;
    CHECK(
        open_text(
            &g,
            "temp_k,entity,part,t_s\n201,*,*,0\n202,*,engine_deck,0\n203,*,deck,0\n204,tank,*,0\n205,tank,engine_deck,0\n"
            "206,1:1:2,*,0\n207,1:1:2,grille,0\n") == STATUS_OK);
    CHECK(k_of(g, first, &truck, 0, 0) == 201 && k_of(g, first, &truck, 2, 0) == 202 &&
          k_of(g, first, &truck, 1, 0) == 203);
    CHECK(k_of(g, first, &tank, 0, 0) == 204 && k_of(g, first, &tank, 1, 0) == 205 &&
          k_of(g, first, &tank, 2, 0) == 205);
    CHECK(k_of(g, second, &tank, 1, 0) == 206 && k_of(g, second, &tank, 2, 0) == 207 &&
          k_of(g, second, &truck, 0, 0) == 206);
    given_heat_close(g);
}

/* A part may be called as a role is, and have another; ids are numbers, however they are written. */
static void names_that_are_roles(void **state)
{
    (void)state;
    GivenHeat *g;
    CHECK(open_text(&g, "entity,part,t_s,temp_k\n*,exhaust,0,500\n01:1:1,hull,0,300\n1:1:1,hull,10,310\n") ==
          STATUS_OK);
    CHECK(k_of(g, first, &tank, 3, 0) == 500);
    CHECK_NEAR(k_of(g, first, &tank, 0, 5), 305, 1e-9);
    given_heat_close(g);
    CHECK(open_text(&g, "entity,part,t_s,temp_k\n01:1:1,hull,0,300\n1:1:1,hull,0,350\n") == STATUS_BAD_VALUE);
}

static void what_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"entity,part,t_s\ntank,hull,0\n", "no column temp_k"},
        {"entity,part,t_s,temp_k\ntank,hull,0,0.5\n", "temp_k"},
        {"entity,part,t_s,temp_k\ntank,hull,0,4001\n", "temp_k"},
        {"entity,part,t_s,temp_k\ntank,hull,0,nan\n", "temp_k"},
        {"entity,part,t_s,temp_k\ntank,hull,inf,300\n", "t_s"},
        {"entity,part,t_s,temp_k\ntank,hull,,300\n", "t_s"},
        {"entity,part,t_s,temp_k\ntank,hull,0,300\ntank,*,0,300\ntank,hull,0,301\n", ":4"},
        {"entity,part,t_s,temp_k\ntank,hull,5,300\ntank,hull,4,301\n", "ascend"},
        {"entity,part,t_s,temp_k\n,hull,5,300\n", "empty"},
        {"entity,part,t_s,temp_k\ntank,,5,300\n", "empty"},
        {"entity,part,t_s,temp_k\ntank,hull,5\n", ":2"},
        {"", "pitviper-test"},
    };
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        GivenHeat *g;
        check_said[0] = 0;
        CHECK(open_text(&g, bad[i].text) != STATUS_OK && !g);
        if (!strstr(check_said, bad[i].says)) print_message("%zu said: %s\n", i, check_said);
        CHECK(strstr(check_said, bad[i].says));
    }
    GivenHeat *g = NULL;
    CHECK(given_heat_open(&g, "/none/at/all.csv") != STATUS_OK && !g);
    log_set_sink(NULL, NULL);
    CHECK(open_text(&g, "entity,part,t_s,temp_k\n") == STATUS_OK); /* no rows: nothing is given */
    CHECK(isnan(k_of(g, first, &tank, 0, 0)));
    given_heat_close(g);
    given_heat_close(NULL);
}

static Status open_kept(KeptHeat **out, const char *rows)
{
    static char text[1 << 15];
    char        path[text_file_size];
    snprintf(text, sizeof text, "entity,model,unix_s,node_k\n%s", rows);
    text_file(path, text);
    *out = NULL;
    const Status status = heat_kept_open(out, path);
    remove(path);
    return status;
}

/* Rows in any order are found by id, model and number of nodes; of two of an id the first counts. Temperatures are 0.5
 * .. 10000 K, times within 1e12 s of 1970, given times within 1e9 s; bounds themselves are in. */
static void kept_rows(void **state)
{
    (void)state;
    KeptHeat        *k;
    const KeptNodes *n;
    CHECK(open_kept(&k,
                    "3:1:1,tank,-1e12,300\n1:1:2,tank,1e12,0.5 10000\n1:1:1,truck,5,  290 291  292 \n3:1:1,tank,7,400\n"
                    "2:1:1,tank,9,280\n") == STATUS_OK);
    n = heat_kept_find(k, second, "tank", 2);
    CHECK(n && n->temp_k[0] == 0.5 && n->temp_k[1] == 10000 && n->unix_s == 1e12);
    n = heat_kept_find(k, first, "truck", 3);
    CHECK(n && n->temp_k[0] == 290 && n->temp_k[2] == 292 && n->unix_s == 5);
    n = heat_kept_find(k, (DisEntityId){3, 1, 1}, "tank", 1);
    CHECK(n && n->temp_k[0] == 300 && n->unix_s == -1e12);
    CHECK(heat_kept_find(k, (DisEntityId){2, 1, 1}, "tank", 1)->temp_k[0] == 280);
    CHECK(!heat_kept_find(k, first, "tank", 3) && !heat_kept_find(k, first, "truck", 2));
    CHECK(!heat_kept_find(k, (DisEntityId){2, 2, 1}, "tank", 1) &&
          !heat_kept_find(k, (DisEntityId){9, 1, 1}, "tank", 1));
    heat_kept_close(k);
    static const char *const bad[] = {"1:1:1,tank,5,0.49\n",       "1:1:1,tank,5,10001\n", "1:1:1,tank,1.05e12,300\n",
                                      "1:1:1,tank,-1.05e12,300\n", "1:1:1,tank,5,\n",      "1:1:1,tank,5,300 x\n",
                                      "1:1:1,tank,5,300;301\n",    "1:1,tank,5,300\n"};
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) CHECK(open_kept(&k, bad[i]) != STATUS_OK && !k);
    GivenHeat *g;
    CHECK(open_text(&g, "entity,part,t_s,temp_k\n*,*,-1e9,1\n*,*,1e9,4000\n") == STATUS_OK);
    CHECK_NEAR(k_of(g, first, &tank, 0, 0), 2000.5, 1e-9);
    given_heat_close(g);
    CHECK(open_text(&g, "entity,part,t_s,temp_k\n*,*,-1.05e9,1\n") != STATUS_OK &&
          open_text(&g, "entity,part,t_s,temp_k\n*,*,1.05e9,1\n") != STATUS_OK);
    log_set_sink(NULL, NULL);
}

/* A row of 4096 temperatures is read, one of 4097 refused. */
static void as_many_nodes_as_there_is_room_for(void **state)
{
    (void)state;
    enum { most = 4096 };
    static char rows[6 * most + 100];
    KeptHeat   *k;
    log_set_sink(check_listen, NULL);
    for (int more = 0; more < 2; more++) {
        int at = sprintf(rows, "1:1:1,tank,5,");
        for (int n = 0; n < most + more; n++) at += sprintf(rows + at, "%d ", 200 + n % 100);
        sprintf(rows + at, "\n");
        const Status status = open_kept(&k, rows);
        CHECK((status == STATUS_OK) == (more == 0) && (k == NULL) == (more == 1));
        if (!k) continue;
        const KeptNodes *n = heat_kept_find(k, first, "tank", most);
        CHECK(n && n->temp_k[0] == 200 && n->temp_k[most - 1] == 200 + (most - 1) % 100);
        heat_kept_close(k);
    }
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(lines_between_rows),
                                       cmocka_unit_test(the_closest_name_wins),
                                       cmocka_unit_test(names_that_are_roles),
                                       cmocka_unit_test(what_is_refused),
                                       cmocka_unit_test(kept_rows),
                                       cmocka_unit_test(as_many_nodes_as_there_is_room_for)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
