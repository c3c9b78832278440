/* tests/entities/test_entity_eviction.c: which entities are kept when the table is full: against a list that is
 * searched from end to end, and in floods of invented entities. */
#include "tests/entities/entity_fixture.h"
#include "entities/table/entity_limits_private.h"

/* ---- ranks against a plain list ------------------------------------------------------------- */

enum { slots = 61, capacity = 60 };

typedef struct Plain {
    bool        there, known;
    DisEntityId id;
    int class;
    int heard;
} Plain;

static Plain plain[slots];

static int tier_of(const Plain *p) { return 2 * p->known + (p->class <= 4); }

/* By the words of entity_limits_private.h alone. */
static int plain_worst(void)
{
    int total[4] = {0}, tier = -1, most = 0, worst = -1;
    for (int i = 0; i < slots; i++) total[tier_of(&plain[i])] += plain[i].there;
    for (int t = 3; t >= 0; t--)
        if (total[t] > 0) tier = t;
    for (int t = 3; t >= 0; t--)
        if (total[t] > capacity / 4) tier = t;
    DisEntityId sender = {0};
    for (int i = 0; i < slots; i++) {
        int count = 0;
        if (!plain[i].there || tier_of(&plain[i]) != tier) continue;
        for (int k = 0; k < slots; k++)
            count += plain[k].there && tier_of(&plain[k]) == tier && plain[k].id.site == plain[i].id.site &&
                     plain[k].id.application == plain[i].id.application;
        const DisEntityId its = {plain[i].id.site, plain[i].id.application, 0};
        if (count > most || (count == most && dis_entity_id_compare(its, sender) > 0)) most = count, sender = its;
    }
    for (int i = 0; i < slots; i++) {
        const Plain *p = &plain[i], *w = &plain[worst < 0 ? 0 : worst];
        if (!p->there || tier_of(p) != tier || p->id.site != sender.site || p->id.application != sender.application)
            continue;
        if (worst < 0 || p->class > w->class || (p->class == w->class && p->heard < w->heard)) worst = i;
    }
    return worst;
}

static int dice(uint64_t n, uint32_t what, int sides) { return (int)(random_uniform(11, 3, what, n) * sides); }

static int plain_class(const void *user, int slot)
{
    (void)user;
    return plain[slot].class;
}

static void ranks_agree_with_a_list(void **state)
{
    (void)state;
    EntityRanks *ranks = NULL;
    CHECK(entity_ranks_create(&ranks, slots, capacity) == STATUS_OK);
    CHECK(entity_ranks_worst(ranks) == -1);
    int tiers_seen = 0;
    for (int n = 0; n < 20000; n++) {
        const uint64_t at = (uint64_t)n;
        const int      slot = dice(at, 0, slots), senders = 1 + n / 2000; /* few have much, many have little */
        Plain         *p = &plain[slot];
        if (dice(at, 1, 400) == 0) { /* the place that matters is another */
            for (int i = 0; i < slots; i++) plain[i].class = dice(at, (uint32_t)(10 + i), 16);
            entity_ranks_again(ranks, plain_class, NULL);
        } else if (dice(at, 2, 8) == 0) {
            entity_ranks_remove(ranks, slot);
            p->there = false;
        } else {
            if (!p->there) {
                p->id = (DisEntityId){(uint16_t)dice(at, 3, senders), (uint16_t)dice(at, 4, 3), (uint16_t)slot};
                p->known = false;
            }
            p->there = true;
            p->known |= dice(at, 5, 4) == 0;
            p->class = dice(at, 6, 16);
            p->heard = n;
            entity_ranks_put(ranks, slot, p->id, p->known, p->class);
        }
        const int worst = entity_ranks_worst(ranks);
        assert_int_equal(worst, plain_worst());
        if (worst >= 0) tiers_seen |= 1 << tier_of(&plain[worst]);
    }
    CHECK(tiers_seen == 15);
    entity_ranks_destroy(ranks);
}

static void distances_are_in_classes_of_twice(void **state)
{
    (void)state;
    static const double here[3] = {earth_radius_m, 0, 0};
    static const struct {
        double m;
        int class;
    } want[] = {{0, 0},     {625, 0},   {626, 1},  {1250, 1}, {9999, 4},
                {10000, 4}, {10001, 5}, {1e7, 14}, {3e7, 15}, {NAN, 15}};
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        const double there[3] = {earth_radius_m, 0, want[i].m};
        assert_int_equal(entity_rank_class(there, here), want[i].class);
    }
}

/* ---- floods ------------------------------------------------------------------------------------ */

enum { table_capacity = 4000, flood_count = 10000 };

static const DisEntityId host_id = {1, 3001, 41}, none_id = {0, 0, 0};

static DisEntityState state_of(DisEntityId id, double north_m, DisEntityType type)
{
    DisEntityState pdu = report(1, type);
    pdu.id = id;
    pdu.p_ecef[2] = north_m;
    return pdu;
}

static bool is_there(const Fixture *f, DisEntityId id)
{
    return entity_table_alive(f->table, entity_table_find(f->table, id));
}

/* Entity n of a flood of so many senders. */
static DisEntityId flood_id(int n, int senders)
{
    return (DisEntityId){(uint16_t)(1000 + n % senders), 7, (uint16_t)(1 + n / senders)};
}

static void flood(Fixture *f, int senders, double north_m, double from_s, int rounds)
{
    for (int n = 0; n < flood_count * rounds; n++) {
        const DisEntityState pdu = state_of(flood_id(n % flood_count, senders), north_m, tank_type);
        entity_table_entity_state(f->table, &pdu, from_s + 2.5 * n / flood_count);
    }
}

static Fixture open_full(void)
{
    EntityTableConfig config = entity_table_default_config();
    config.capacity = table_capacity;
    return fixture_open(&config);
}

/* An exercise of 20 entities that reports at 0 and 5 s, 2 km from the host to come. */
static void exercise(Fixture *f, double t_s)
{
    for (int e = 1; e <= 20; e++) {
        const DisEntityState pdu = state_of(entity_id(e), 2000 + 10 * e, tank_type);
        hear(f, &pdu, t_s);
    }
}

static void check_exercise(const Fixture *f)
{
    for (int e = 1; e <= 20; e++) CHECK(is_there(f, entity_id(e)));
}

/* A missile that comes after a flood is taken in, and stays through the next one; so do those that were there before.
 * The same with many senders, and with invented entities where the missile is. */
static void a_missile_after_a_flood_is_taken_in(void **state)
{
    (void)state;
    static const int    senders[] = {1, 3, 1000};
    static const double north_m[] = {3e5, 2000};
    for (int k = 0; k < 6; k++) {
        Fixture f = open_full();
        exercise(&f, 0);
        exercise(&f, 5);
        flood(&f, senders[k % 3], north_m[k / 3], 5.1, 1);
        assert_int_equal(entity_table_count(f.table), table_capacity);
        check_exercise(&f);
        const DisEntityState missile = state_of(host_id, 0, missile_type);
        CHECK(entity_table_entity_state(f.table, &missile, 8) == STATUS_OK);
        CHECK(is_there(&f, host_id));
        entity_table_focus(f.table, host_id, none_id);
        exercise(&f, 10);
        flood(&f, senders[k % 3], north_m[k / 3], 10.1, 2);
        CHECK(is_there(&f, host_id));
        check_exercise(&f);
        assert_int_equal(entity_table_count(f.table), table_capacity);
        const EntityCounters *c = entity_table_counters(f.table);
        CHECK(c->evicted + c->refused > 0 && c->created == (uint64_t)table_capacity + c->evicted);
        fixture_close(&f);
    }
}

/* A flood in the name of the missile's own sender: the others that are stale go first, as long as it goes on reporting.
 */
static void a_flood_of_its_own_sender(void **state)
{
    (void)state;
    Fixture              f = open_full();
    const DisEntityState missile = state_of(host_id, 0, missile_type);
    for (int n = 0; n < 3 * flood_count; n++) {
        const DisEntityState pdu = state_of((DisEntityId){1, 3001, (uint16_t)(100 + n % 60000)}, 500, tank_type);
        entity_table_entity_state(f.table, &pdu, 2.5 * n / flood_count);
        if (n % 500 == 0) hear(&f, &missile, 2.5 * n / flood_count);
    }
    CHECK(is_there(&f, host_id));
    fixture_close(&f);
}

/* Of one sender's the farthest from the host's last report go first, and what comes still farther is not taken in. */
static void the_farthest_goes_first(void **state)
{
    (void)state;
    EntityTableConfig config = entity_table_default_config();
    config.capacity = 8;
    Fixture        f = fixture_open(&config);
    DisEntityState host = state_of(host_id, 0, missile_type);
    entity_table_focus(f.table, host_id, none_id);
    hear(&f, &host, 0);
    for (int e = 1; e <= 7; e++) { /* 1.4 km .. 5000 km */
        const DisEntityState pdu = state_of(entity_id(e), 450 * pow(3.8, e), tank_type);
        hear(&f, &pdu, 1);
    }
    DisEntityState more = state_of(entity_id(50), 1.2e7, tank_type);
    CHECK(entity_table_entity_state(f.table, &more, 1.1) == STATUS_UNSUPPORTED && !is_there(&f, entity_id(50)));
    more.p_ecef[2] = 3000;
    for (int e = 7; e >= 5; e--) {
        more.id.entity = (uint16_t)(50 + e);
        CHECK(is_there(&f, entity_id(e)));
        hear(&f, &more, 1.2);
        CHECK(!is_there(&f, entity_id(e)) && is_there(&f, more.id));
    }
    CHECK(entity_table_counters(f.table)->evicted == 3 && entity_table_counters(f.table)->refused == 1);
    /* the host is elsewhere: others are far from it */
    host.p_ecef[2] = 1.5e5;
    hear(&f, &host, 3);
    more.id.entity = 60;
    more.p_ecef[2] = 1.5e5;
    hear(&f, &more, 3.1);
    CHECK(is_there(&f, entity_id(4)) && is_there(&f, entity_id(60)) && is_there(&f, host_id));
    fixture_close(&f);
}

/* Ranks follow the host that they are measured from, without a report of the others. Two entities of one sender, 2 km
 * and 100 km north of it; a third comes, and one has to go: the far one. Where the host has moved on by 100 km since,
 * that is the other. A focus that is moved to another host measures from there at once, and the old host is one of many
 * again. */
static void ranks_follow_the_host(void **state)
{
    (void)state;
    enum { at_home, moved, moved_a_second_time, moved_in_steps, another_host, cases };
    for (int c = 0; c < cases; c++) {
        EntityTableConfig config = entity_table_default_config();
        config.capacity = c == another_host ? 4 : 3;
        Fixture              f = fixture_open(&config);
        DisEntityState       host = state_of(host_id, 0, missile_type);
        const DisEntityId    other_id = {1, 3001, 42};
        const DisEntityState near = state_of(entity_id(1), 2000, tank_type),
                             far = state_of(entity_id(2), 1e5, tank_type);
        const DisEntityState more = state_of(entity_id(3), c == at_home ? 500 : 1.005e5, tank_type);
        const DisEntityState other = state_of(other_id, 1.01e5, missile_type);
        entity_table_focus(f.table, host_id, none_id);
        hear(&f, &host, 0);
        hear(&f, &near, 0.1);
        hear(&f, &far, 0.1);
        if (c == another_host) hear(&f, &other, 0.1);
        for (int step = 1; c == moved_in_steps && step <= 250; step++) { /* 400 m a step, below the 500 m that count */
            host.p_ecef[2] = 400 * step;
            hear(&f, &host, 0.2 + 2 * step);
        }
        if (c == moved || c == moved_a_second_time) {
            host.p_ecef[2] = c == moved ? 1e5 : -3e5;
            hear(&f, &host, 2);
        }
        if (c == moved_a_second_time) {
            host.p_ecef[2] = 1e5;
            hear(&f, &host, 4);
        }
        if (c == another_host) entity_table_focus(f.table, other_id, none_id);
        hear(&f, &more, 600);
        CHECK(is_there(&f, entity_id(1)) == (c == at_home) && is_there(&f, entity_id(2)) == (c != at_home));
        CHECK(is_there(&f, entity_id(3)) && is_there(&f, host_id) && (c != another_host || is_there(&f, other_id)));
        if (c == another_host) { /* the first one comes back: of the two far ones it has reported last */
            hear(&f, &near, 601);
            CHECK(!is_there(&f, host_id) && is_there(&f, entity_id(1)) && is_there(&f, entity_id(2)));
        }
        fixture_close(&f);
    }
}

/* What counts is a move of more than 500 m. One 500 m south of the host and one 700 m north of it are of different
 * classes (625 m); once the host is 600 m farther north it is the other way round, and a newcomer takes the place of
 * the southern one. After 400 m ranks are as before. */
static void a_small_move_changes_no_rank(void **state)
{
    (void)state;
    for (int far = 0; far < 2; far++) {
        EntityTableConfig config = entity_table_default_config();
        config.capacity = 3;
        Fixture              f = fixture_open(&config);
        DisEntityState       host = state_of(host_id, 0, missile_type);
        const DisEntityState south = state_of(entity_id(1), -500, tank_type),
                             north = state_of(entity_id(2), 700, tank_type);
        const DisEntityState more = state_of(entity_id(3), 500, tank_type);
        entity_table_focus(f.table, host_id, none_id);
        hear(&f, &host, 0), hear(&f, &south, 0.1), hear(&f, &north, 0.2);
        host.p_ecef[2] = far ? 600 : 400;
        hear(&f, &host, 2), hear(&f, &more, 2.1);
        CHECK(is_there(&f, entity_id(1)) == !far && is_there(&f, entity_id(2)) == far && is_there(&f, entity_id(3)));
        fixture_close(&f);
    }
}

/* Ranks are computed again once a second at most. The same two entities; the host has moved by 600 m 0.95 s, or 1.05 s,
 * after the last time, which was its first report, or, for the later rows, a move of 2 km and back that took 4 s. */
static void ranks_are_computed_once_a_second(void **state)
{
    (void)state;
    for (int c = 0; c < 4; c++) {
        const bool        later = c >= 2, known = c % 2;
        EntityTableConfig config = entity_table_default_config();
        config.capacity = 3;
        Fixture              f = fixture_open(&config);
        DisEntityState       host = state_of(host_id, 0, missile_type);
        const DisEntityState south = state_of(entity_id(1), -500, tank_type),
                             north = state_of(entity_id(2), 700, tank_type);
        const DisEntityState more = state_of(entity_id(3), 500, tank_type);
        entity_table_focus(f.table, host_id, none_id);
        hear(&f, &host, 0), hear(&f, &south, 0.1), hear(&f, &north, 0.2);
        for (int leg = 1; later && leg <= 2; leg++) {
            host.p_ecef[2] = leg == 1 ? 2000 : 0;
            hear(&f, &host, 2 * leg);
        }
        host.p_ecef[2] = 600;
        const double now_s = (later ? 4 : 0) + (known ? 1.05 : 0.95);
        hear(&f, &host, now_s), hear(&f, &more, now_s + 0.01);
        CHECK(is_there(&f, entity_id(1)) == !known && is_there(&f, entity_id(2)) == known &&
              is_there(&f, entity_id(3)));
        fixture_close(&f);
    }
}

/* The second entity of the focus, the aim, is never evicted either, and is one of many once it is the aim no more. */
static void the_aim_is_kept(void **state)
{
    (void)state;
    for (int aimed = 0; aimed < 2; aimed++) {
        EntityTableConfig config = entity_table_default_config();
        config.capacity = 3;
        Fixture              f = fixture_open(&config);
        const DisEntityState host = state_of(host_id, 0, missile_type), aim = state_of(entity_id(2), 1e5, tank_type);
        const DisEntityState near = state_of(entity_id(1), 2000, tank_type),
                             more = state_of(entity_id(3), 500, tank_type);
        entity_table_focus(f.table, host_id, entity_id(2));
        hear(&f, &host, 0), hear(&f, &aim, 0.1), hear(&f, &near, 0.1);
        if (!aimed) entity_table_focus(f.table, host_id, none_id);
        hear(&f, &more, 1);
        CHECK(is_there(&f, entity_id(2)) == aimed && is_there(&f, entity_id(1)) == !aimed &&
              is_there(&f, entity_id(3)));
        fixture_close(&f);
    }
}

/* An entity is known a second after its first report, and a known one outlives a new one that is nearer. */
static void a_second_makes_it_known(void **state)
{
    (void)state;
    for (int known = 0; known < 2; known++) {
        EntityTableConfig config = entity_table_default_config();
        config.capacity = 3;
        Fixture              f = fixture_open(&config);
        const DisEntityState host = state_of(host_id, 0, missile_type), far = state_of(entity_id(2), 9000, tank_type);
        const DisEntityState near = state_of(entity_id(1), 2000, tank_type),
                             more = state_of(entity_id(3), 500, tank_type);
        entity_table_focus(f.table, host_id, none_id);
        hear(&f, &host, 0), hear(&f, &far, 0), hear(&f, &far, known ? 1 : 0.99);
        hear(&f, &near, 1), hear(&f, &more, 1);
        CHECK(is_there(&f, entity_id(2)) == known && is_there(&f, entity_id(1)) == !known &&
              is_there(&f, entity_id(3)));
        fixture_close(&f);
    }
}

/* What snapshots are taken in between, and how long each waits to be removed, changes nothing. */
static void it_does_not_depend_on_snapshots(void **state)
{
    (void)state;
    Fixture one = open_full(), other = open_full();
    for (int k = 0; k < 2; k++) {
        Fixture *f = k ? &other : &one;
        entity_table_focus(f->table, host_id, none_id);
        for (int n = 0; n < flood_count; n++) {
            const double   t_s = 1e-3 * n;
            DisEntityState pdu = state_of(flood_id((int)(random_uniform(5, 1, 0, (uint64_t)n) * 9000), 1 + n / 100),
                                          4e4 * random_uniform(5, 1, 1, (uint64_t)n), tank_type);
            if (n % 100 == 0) pdu = state_of(host_id, 30.0 * n, missile_type);
            pdu.velocity_mps[2] = 300;
            entity_table_entity_state(f->table, &pdu, t_s);
            if (k && n % 1000 == 0) seen_at(f, 1, t_s + 0.001 * (n % 7));
        }
    }
    seen_at(&one, 1, 11);
    arena_reset(other.arena);
    CHECK(entity_table_snapshot(&other.snapshot, other.table, 11, other.arena) == STATUS_OK);
    assert_int_equal(one.snapshot.count, other.snapshot.count);
    for (int i = 0; i < one.snapshot.count; i++)
        CHECK(dis_entity_id_compare(one.snapshot.entity[i].id, other.snapshot.entity[i].id) == 0);
    fixture_close(&one);
    fixture_close(&other);
}

/* ---- snapshots of a part -------------------------------------------------------------------------- */

/* The nearest by what was reported, whatever they are extrapolated to; host and aim always. */
static void a_snapshot_takes_the_nearest(void **state)
{
    (void)state;
    enum { all = 500, shown = 37, aim = 400 };
    EntityTableConfig config = entity_table_default_config();
    config.shown = shown;
    Fixture        f = fixture_open(&config);
    DisEntityState host = state_of(host_id, 0, helicopter_type);
    double         north_m[all];
    entity_table_focus(f.table, host_id, entity_id(100 + aim));
    hear(&f, &host, 0);
    for (int e = 0; e < all; e++) {
        north_m[e] = e == aim ? 1e6 : 1e4 * random_uniform(8, 1, 0, (uint64_t)e);
        if (e % 5 == 0 && e > 0 && e != aim) north_m[e] = north_m[e - 1]; /* as near as another */
        DisEntityState pdu = state_of(entity_id(100 + e), north_m[e], tank_type);
        pdu.velocity_mps[2] = e % 2 ? -300 : 300;
        hear(&f, &pdu, 0);
    }
    seen_at(&f, 1, 5);
    assert_int_equal(f.snapshot.count, shown);
    assert_int_equal(f.snapshot.left_out, all + 1 - shown);
    CHECK(seen_at(&f, 41, 5) && seen_at(&f, 100 + aim, 5));
    for (int e = 0; e < all; e++) {
        int nearer = 0; /* of the others, with the lower id where they are as near */
        for (int k = 0; k < all; k++)
            nearer += k != aim && (north_m[k] < north_m[e] || (north_m[k] == north_m[e] && k < e));
        if (e != aim) CHECK((seen_at(&f, 100 + e, 5) != NULL) == (nearer < shown - 2));
    }
    fixture_close(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ranks_agree_with_a_list),
        cmocka_unit_test(distances_are_in_classes_of_twice),
        cmocka_unit_test(a_missile_after_a_flood_is_taken_in),
        cmocka_unit_test(a_flood_of_its_own_sender),
        cmocka_unit_test(the_farthest_goes_first),
        cmocka_unit_test(ranks_follow_the_host),
        cmocka_unit_test(a_small_move_changes_no_rank),
        cmocka_unit_test(ranks_are_computed_once_a_second),
        cmocka_unit_test(the_aim_is_kept),
        cmocka_unit_test(a_second_makes_it_known),
        cmocka_unit_test(it_does_not_depend_on_snapshots),
        cmocka_unit_test(a_snapshot_takes_the_nearest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
