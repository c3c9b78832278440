/* tests/fuzz/fuzz_entities.c: any octets as the PDUs of an exercise: surveyed, played, and asked who is there. Without
 * a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"
#include "tests/dis/random_pdu.h"

#include "entities/survey/survey.h"
#include "sensor/node/player/player.h"

#include <stdlib.h>

const int fuzz_rounds = 3000;

enum { most_datagrams = 64 };

static void put_be(uint8_t *at, uint64_t value, int octets)
{
    for (int i = 0; i < octets; i++) at[i] = (uint8_t)(value >> 8 * (octets - 1 - i));
}

static void put_place(uint8_t *at, double x_m, double y_m, double z_m)
{
    const double place[3] = {x_m, y_m, z_m};
    for (int i = 0; i < 3; i++) {
        uint64_t bits;
        memcpy(&bits, &place[i], sizeof bits);
        put_be(at + 8 * i, bits, 8);
    }
}

/* Random fields, but identities that meet again, places on the Earth and stamps that advance. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const uint8_t exercise = 1;
    Dice                 d = dice(index);
    size_t               octets = 0;
    const int            pdus = 2 + (int)(roll(&d) % 8);
    for (int i = 0; i < pdus; i++) {
        const int    kind = (int)(roll(&d) % random_pdu_kinds);
        uint8_t     *pdu = out + octets;
        const size_t length = random_pdu(pdu, &d, kind);
        pdu[1] = exercise;
        put_be(pdu + 4, (uint64_t)(index * 1000003u + (uint32_t)i * 1193046u) << 1, 4);
        put_be(pdu + 12, 1, 2);
        put_be(pdu + 14, 2, 2);
        put_be(pdu + 16, 1 + roll(&d) % 3, 2);
        const double x_m = 6378137 + roll(&d) % 100, y_m = roll(&d) % 1000, z_m = roll(&d) % 1000;
        if (kind == 0) {
            put_place(pdu + 48, x_m, y_m, z_m);
            memset(pdu + 36, 0, 12);  /* velocity */
            memset(pdu + 72, 0, 12);  /* attitude */
            memset(pdu + 104, 0, 24); /* acceleration, angular rate */
            pdu[20] = (uint8_t)(1 + roll(&d) % 3);
            pdu[87] &= 0x5f; /* neither frozen nor deactivated */
        } else if (kind == 1) {
            memset(pdu + 20, 0, 12);
            put_place(pdu + 32, x_m, y_m, z_m);
        } else if (kind == 2 || kind == 3) {
            put_place(pdu + (kind == 2 ? 40 : 48), x_m, y_m, z_m);
        }
        octets += length;
    }
    return octets;
}

/* The datagram cut where its PDUs say that they end. */
static int cut(DisDatagram out[most_datagrams], const uint8_t *data, size_t size)
{
    int count = 0;
    for (size_t at = 0; at < size && count < most_datagrams; count++) {
        size_t length = size - at;
        if (length >= dis_header_octets && count < most_datagrams - 1) {
            const size_t said = (size_t)(data[at + 8] << 8 | data[at + 9]);
            if (said >= dis_header_octets && said < length) length = said;
        }
        out[count] = (DisDatagram){.capture_s = 1.6e9 + 0.125 * count,
                                   .packet = (uint32_t)count + 1,
                                   .octets = (uint32_t)length,
                                   .bytes = data + at};
        at += length;
    }
    return count;
}

static void check_survey(const DisLog *log, int exercise)
{
    Survey survey;
    if (survey_log(&survey, log, exercise) != STATUS_OK) return;
    for (int t = 0; t < survey.track_count; t++) {
        const Track *track = survey.track + t;
        if (track->count < 1 || survey_track(&survey, track->id) == NULL) abort();
        for (int k = 0; k < track->count; k++) {
            TrackPose pose;
            if (!isfinite(track->point[k].t_s) || !v3_is_finite(track->point[k].p_ecef)) abort();
            if (k > 0 && !(track->point[k].t_s >= track->point[k - 1].t_s)) abort();
            survey_track_at(&pose, track, track->point[k].t_s + 0.3);
            if (!v3_is_finite(pose.p_ecef) || !v3_is_finite(pose.v_ecef_mps)) abort();
        }
    }
    survey_destroy(&survey);
}

static void check_snapshot(const EntityTable *table, double t_s, Arena *arena)
{
    Snapshot snapshot;
    arena_reset(arena);
    if (entity_table_snapshot(&snapshot, table, t_s, arena) != STATUS_OK) return;
    for (int i = 0; i < snapshot.count; i++) {
        const SnapshotEntity *e = snapshot.entity + i;
        if (!v3_is_finite(e->p_ecef) || !v3_is_finite(e->v_ecef_mps) || !v3_is_finite(e->w_body_rps)) abort();
        for (int k = 0; k < 9; k++)
            if (!(fabs(e->r_ecef_from_body[k]) <= 1.001)) abort();
        if (!(e->drives.engine >= 0 && e->drives.engine <= 1 && e->drives.speed_mps >= 0 &&
              isfinite(e->drives.speed_mps) && isfinite(e->drives.fired_kg[0]) && isfinite(e->drives.fired_kg[1])))
            abort();
        if (i > 0 && dis_entity_id_compare(snapshot.entity[i - 1].id, e->id) >= 0) abort();
    }
    for (int i = 0; i < snapshot.puff_count; i++) {
        const EffectPuff *p = snapshot.puff + i;
        if (!v3_is_finite(p->p_ecef) || !isfinite(p->mass_kg) || !(p->age_s >= 0)) abort();
    }
    const GroundMarks *m = &snapshot.marks;
    for (int i = 0; i < m->stands; i++)
        if (!v3_is_finite(m->stand[i].p_ecef) || !(m->stand[i].from_s <= fmin(m->stand[i].to_s, t_s))) abort();
    for (int i = 0; i < m->tracks; i++) {
        const GroundTrack *t = &m->track[i];
        if (!v3_is_finite(t->a_ecef) || !v3_is_finite(t->b_ecef) || !(t->a_s < t->b_s) || !(t->heat_j_m2 >= 0)) abort();
    }
    for (int i = 0; i < m->burns; i++)
        if (!v3_is_finite(m->burn[i].p_ecef) || !(m->burn[i].t_s <= t_s)) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static Catalog *catalog;
    static Arena   *arena;
    log_set_level((LogLevel)(LOG_ERROR + 1));
    if (!catalog) { /* once: with the models of another 0.5 s nothing below would be reached sooner */
        char path[1024];
        if (!etc_path(path, sizeof path, "catalog.csv")) abort();
        if (catalog_open(&catalog, path, 0.1) != STATUS_OK || !(arena = arena_create())) abort();
    }
    DisDatagram datagram[most_datagrams];
    DisLog      log = {.datagram = datagram};
    log.count = cut(datagram, data, size);
    const int exercise = size % 2 ? -1 : 1;
    check_survey(&log, exercise);

    EntityTableConfig config = entity_table_default_config();
    EntityTable      *table = NULL;
    Player           *player = NULL;
    config.capacity = 8;
    if (entity_table_create(&table, &config, catalog) == STATUS_OK &&
        player_create(&player, exercise, size % 3 == 0) == STATUS_OK && player_add_log(player, &log) == STATUS_OK) {
        static const double t_s[] = {-1, 0, 0.1, 1, 3, 60, 4000, 1e7, 1e13};
        for (size_t i = 0; i < sizeof t_s / sizeof *t_s; i++) {
            player_feed(player, table, t_s[i]);
            entity_table_expire(table, t_s[i]);
            check_snapshot(table, t_s[i], arena);
            if (entity_table_count(table) > config.capacity) abort();
        }
    }
    player_destroy(player);
    entity_table_destroy(table);
    return 0;
}
