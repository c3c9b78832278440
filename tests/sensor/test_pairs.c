/* What is taken away from a frame's snapshot for its background: the entities, and what belongs to them alone. */
#include "tests/check.h"

#include "entities/table/entity_index.h"
#include "sensor/publish/consumers/consume_pairs.h"

enum { entities = 7 };

static struct {
    Frame          frame;
    FrameView      without;
    SnapshotEntity entity[entities];
    EffectPuff     puff[entities + 2];
    GroundStand    stand[entities + 2];
    GroundTrack    track[entities + 2];
    Arena         *arena;
} lab;

/* Entity k is 1:2:(10 + 3 k), of model 100 + k. Each has a puff, marks where it stood and a track; so has the id 0,
 * and one that is not there any more. */
static void fill(void)
{
    lab.without = (FrameView){.plane_count = 0};
    lab.frame = (Frame){.arena = lab.arena, .without = &lab.without};
    for (int k = 0; k < entities + 2; k++) {
        const DisEntityId id = {1, 2, (uint16_t)(10 + 3 * k)};
        const uint64_t    owner = k <= entities ? entity_key(id) + 1 : 0;
        if (k < entities) lab.entity[k] = (SnapshotEntity){.id = id, .model = 100 + k};
        lab.puff[k] = (EffectPuff){.owner = owner, .seed = (uint32_t)k};
        lab.stand[k] = (GroundStand){.owner = owner, .from_s = k};
        lab.track[k] = (GroundTrack){.owner = owner, .a_s = k};
    }
    lab.frame.seen.snapshot =
        (Snapshot){.t_s = 4.5,
                   .count = entities,
                   .entity = lab.entity,
                   .puff_count = entities + 2,
                   .puff = lab.puff,
                   .marks = {.stands = entities + 2, .tracks = entities + 2, .stand = lab.stand, .track = lab.track}};
}

/* Takes away, and checks that just the entities of these bits are gone. */
static void check_taken(const PairsTaken *take, unsigned gone)
{
    fill();
    CHECK(pairs_take_away(&lab.frame, take) == STATUS_OK);
    const Snapshot *s = &lab.without.snapshot;
    CHECK(s->count == entities && s->t_s == 4.5);
    int taken = 0, kept = 0;
    for (int k = 0; k < entities; k++) {
        const bool is_gone = gone >> k & 1;
        CHECK(s->entity[k].model == (is_gone ? -1 : 100 + k) && s->entity[k].id.entity == 10 + 3 * k);
        CHECK(lab.entity[k].model == 100 + k); /* of the frame itself nothing changes */
        if (is_gone) CHECK(lab.frame.taken[taken++].entity == 10 + 3 * k);
    }
    CHECK(lab.frame.taken_count == taken);
    for (int k = 0; k < entities + 2; k++) {
        if (k < entities && gone >> k & 1) continue;
        CHECK(s->puff[kept].seed == (uint32_t)k && s->marks.stand[kept].from_s == k && s->marks.track[kept].a_s == k);
        kept++;
    }
    CHECK(s->puff_count == kept && s->marks.stands == kept && s->marks.tracks == kept);
    CHECK(lab.frame.seen.snapshot.puff_count == entities + 2);
}

static void the_aim_or_all_but_the_host(void **state)
{
    (void)state;
    const unsigned all = (1u << entities) - 1;
    check_taken(&(PairsTaken){.all = true, .host = -1}, all);
    for (int host = 0; host < entities; host++)
        check_taken(&(PairsTaken){.all = true, .host = host}, all & ~(1u << host));
    for (int aim = 0; aim < entities; aim++) {
        const DisEntityId id = {1, 2, (uint16_t)(10 + 3 * aim)};
        check_taken(&(PairsTaken){.aim = id, .host = -1}, 1u << aim);
        check_taken(&(PairsTaken){.aim = id, .host = (aim + 1) % entities}, 1u << aim);
        check_taken(&(PairsTaken){.aim = id, .host = aim}, 0); /* the eye stays */
        check_taken(&(PairsTaken){.aim = id, .all = true, .host = -1}, all);
    }
    check_taken(&(PairsTaken){.host = -1}, 0);                    /* no aim */
    check_taken(&(PairsTaken){.aim = {1, 2, 11}, .host = -1}, 0); /* one that is not there */
    check_taken(&(PairsTaken){.aim = {1, 2, 10 + 3 * entities}, .host = -1}, 0);
    fill();
    lab.frame.seen.snapshot = (Snapshot){.count = 0}; /* an empty one */
    CHECK(pairs_take_away(&lab.frame, &(PairsTaken){.all = true, .host = -1}) == STATUS_OK &&
          lab.frame.taken_count == 0);
}

static int open_lab(void **state)
{
    (void)state;
    lab.arena = arena_create();
    return lab.arena ? 0 : -1;
}

static int close_lab(void **state)
{
    (void)state;
    arena_destroy(lab.arena);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_aim_or_all_but_the_host)};
    return cmocka_run_group_tests(tests, open_lab, close_lab);
}
