/* entities/traces/effect_history.c: two ring buffers, and the puffs computed from them. */
#include "entities/traces/effect_history.h"

#include <stdlib.h>

typedef struct EffectEvent {
    double   t_s;
    bool     detonation, guided, kinetic;
    uint8_t  result;
    uint64_t key, seed;
    double   p_ecef[3], d_ecef[3]; /* place; unit direction of flight, or up where it has none */
    double   charge_kg;
} EffectEvent;

struct EffectHistory {
    EffectTable    table;
    double         event_life_s;    /* life of the longest-lived puff of any event */
    uint64_t       events, sources; /* number ever recorded; the last is at (n - 1) % capacity */
    EffectCounters counters;
    EffectEvent    event[effect_event_capacity];
    EffectSource   source[effect_source_capacity];
};

static const double largest_charge_kg = 1000;

Status effect_history_create(EffectHistory **out, const char *path)
{
    EffectHistory *history = calloc(1, sizeof *history);
    if (!history) return STATUS_NO_MEMORY;
    const Status status = effect_table_open(&history->table, path);
    if (status != STATUS_OK) {
        free(history);
        return status;
    }
    for (int k = EFFECT_MUZZLE_FLASH; k <= EFFECT_SPARKS; k++)
        history->event_life_s =
            fmax(history->event_life_s, effect_life_s(&history->table, (EffectKind)k, cbrt(largest_charge_kg)));
    *out = history;
    return STATUS_OK;
}

void                  effect_history_destroy(EffectHistory *history) { free(history); }
const EffectTable    *effect_history_table(const EffectHistory *history) { return &history->table; }
const EffectCounters *effect_history_counters(const EffectHistory *history) { return &history->counters; }

/* ---- events ------------------------------------------------------------------------------- */

/* Domains of munitions and warheads of SISO-REF-010, from memory: 1 anti-air, 2 anti-armour, 8 anti-personnel,
 * 9 battlefield support; category 1 guided; warhead 5000 .. 5999 kinetic, 4000 .. 4999 practice. */
enum { category_guided = 1 };

bool effect_is_kinetic(const DisDescriptor *d) { return d->warhead >= 5000 && d->warhead < 6000; }

double effect_charge_kg(const DisDescriptor *d, bool fire)
{
    static const struct {
        uint8_t domain;
        double  guided[2], ballistic[2];
    } rows[] = {
        /* burst, propellant at the muzzle: kg */
        {1, {8, 4}, {0.1, 0.15}}, {2, {4, 2}, {2, 8}},        {6, {150, 20}, {8, 10}},   {8, {1, 0.5}, {0.02, 0.005}},
        {9, {40, 10}, {8, 8}},    {10, {300, 50}, {100, 50}}, {11, {100, 30}, {50, 20}},
    };
    const bool guided = d->type.category == category_guided;
    double     kg = guided ? (fire ? 2 : 4) : (fire ? 1 : 1);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].domain == d->type.domain) kg = guided ? rows[i].guided[fire] : rows[i].ballistic[fire];
    if (!fire && effect_is_kinetic(d)) kg = fmin(kg, 0.5);
    if (!fire && d->warhead >= 4000 && d->warhead < 5000) kg *= 0.02; /* practice: a spotting charge */
    return fmin(kg, largest_charge_kg);
}

/* Result codes of a Detonation (SISO-REF-010, UID 62, checked against public transcriptions of it): 6 none, 31 .. 33
 * misses that do not burst. */
bool effect_result_is_none(int result) { return result == 6 || (result >= 31 && result <= 33); }
bool effect_result_is_ground(int result) { return result == 3 || result == 4 || (result >= 11 && result <= 13); }
bool effect_result_is_water(int result) { return (result >= 14 && result <= 16) || result == 24; }

static uint64_t mix(uint64_t x)
{
    x ^= x >> 33, x *= UINT64_C(0xff51afd7ed558ccd);
    x ^= x >> 33, x *= UINT64_C(0xc4ceb9fe1a85ec53);
    return x ^ x >> 33;
}

static uint64_t id_bits(uint16_t a, uint16_t b, uint16_t c) { return (uint64_t)a << 32 | (uint64_t)b << 16 | c; }

static void add_event(EffectHistory *h, const EffectEvent *event, const float velocity_mps[3])
{
    static const double same_s = 0.5; /* a PDU repeated within this time is one event */
    const double        r_m = v3_length(event->p_ecef);
    if (!(r_m >= 1e5 && r_m <= 1e8) || !isfinite(event->t_s)) {
        h->counters.refused++;
        return;
    }
    const uint64_t look = h->events < 8 ? h->events : 8;
    for (uint64_t i = 1; i <= look; i++) {
        const EffectEvent *e = &h->event[(h->events - i) % effect_event_capacity];
        if (e->key != event->key || e->detonation != event->detonation || !(fabs(e->t_s - event->t_s) <= same_s) ||
            memcmp(e->p_ecef, event->p_ecef, sizeof e->p_ecef) != 0)
            continue;
        h->counters.repeated++;
        return;
    }
    EffectEvent *to = &h->event[h->events % effect_event_capacity];
    if (h->events >= effect_event_capacity && event->t_s - to->t_s < h->event_life_s) h->counters.events_dropped++;
    *to = *event;
    h->events++;
    const double v[3] = {velocity_mps[0], velocity_mps[1], velocity_mps[2]};
    if (!v3_normalize(to->d_ecef, v)) v3_scale(to->d_ecef, 1 / r_m, event->p_ecef);
    uint64_t bits = event->key;
    for (int i = 0; i < 3; i++) {
        uint64_t p;
        memcpy(&p, &event->p_ecef[i], sizeof p);
        bits = mix(bits ^ p);
    }
    to->seed = bits;
}

void effect_history_fire(EffectHistory *h, const DisFire *pdu, double t_s)
{
    EffectEvent e = {.t_s = t_s,
                     .guided = pdu->descriptor.type.category == category_guided,
                     .key = mix(id_bits(pdu->event.site, pdu->event.application, pdu->event.number)) ^
                            id_bits(pdu->munition.site, pdu->munition.application, pdu->munition.entity),
                     .charge_kg = effect_charge_kg(&pdu->descriptor, true)};
    memcpy(e.p_ecef, pdu->p_ecef, sizeof e.p_ecef);
    add_event(h, &e, pdu->velocity_mps);
}

void effect_history_detonation(EffectHistory *h, const DisDetonation *pdu, double t_s)
{
    EffectEvent e = {.t_s = t_s,
                     .detonation = true,
                     .kinetic = effect_is_kinetic(&pdu->descriptor),
                     .result = pdu->result,
                     .key = mix(id_bits(pdu->event.site, pdu->event.application, pdu->event.number)) ^
                            id_bits(pdu->munition.site, pdu->munition.application, pdu->munition.entity),
                     .charge_kg = effect_charge_kg(&pdu->descriptor, false)};
    memcpy(e.p_ecef, pdu->p_ecef, sizeof e.p_ecef);
    add_event(h, &e, pdu->velocity_mps);
}

/* ---- emissions of entities ---------------------------------------------------------------- */

uint64_t effect_history_open(EffectHistory *h, const EffectSource *source)
{
    EffectSource *to = &h->source[h->sources % effect_source_capacity];
    if (h->sources >= effect_source_capacity &&
        source->from_s < fmin(to->to_s, source->from_s) + effect_life_s(&h->table, to->kind, to->scale))
        h->counters.sources_dropped++;
    *to = *source;
    return ++h->sources;
}

void effect_history_close(EffectHistory *h, uint64_t handle, double t_s)
{
    if (handle == 0 || handle > h->sources || h->sources - handle >= effect_source_capacity) return;
    EffectSource *source = &h->source[(handle - 1) % effect_source_capacity];
    source->to_s = fmin(source->to_s, t_s);
}

/* ---- puffs -------------------------------------------------------------------------------- */

typedef struct PuffList {
    EffectPuff        *out;
    size_t             capacity, count;
    const EffectTable *table;
} PuffList;

static void put(PuffList *list, const EffectPuff *puff)
{
    if (!(puff->age_s >= 0 && puff->age_s < effect_life_s(list->table, puff->kind, puff->scale))) return;
    if (list->count < list->capacity) list->out[list->count] = *puff;
    list->count++;
}

/* A random number in -1 .. 1: number n of puff i. */
static double draw(uint64_t seed, int i, int n) { return 2 * random_uniform(seed, 77, (uint32_t)i, (uint64_t)n) - 1; }

typedef struct Cloud {
    EffectKind kind;
    int        puffs;
    double     delay_s;    /* the times below are multiplied by scale */
    double     ahead, off; /* distance along the direction, and radius about that place; multiplied by scale */
    double     throw_out_mps, throw_up_mps, throw_ahead_mps, throw_s; /* speeds are multiplied by scale */
    double     mass, size;                                            /* shares of the row's mass and size */
    double     stretch; /* length along the direction, as a multiple of the radius at birth; 0: round */
} Cloud;

/* Hits on a building: 18 .. 20. */
static bool result_is_entity(int result)
{
    return result == 1 || (result >= 7 && result <= 10) || (result >= 18 && result <= 20);
}

static void put_cloud(PuffList *list, const EffectEvent *event, int which, const Cloud *c, double t_s)
{
    const double scale = cbrt(event->charge_kg);
    EffectPuff   puff = {.kind = c->kind,
                         .group = (uint32_t)event->seed,
                         .scale = scale * c->size,
                         .throw_s = c->throw_s,
                         .age_s = t_s - event->t_s - c->delay_s * scale,
                         .mass_kg = list->table->law[c->kind].mass_kg * event->charge_kg * c->mass};
    if (!(puff.age_s >= 0)) return;
    puff.grounded = event->detonation && effect_result_is_ground(event->result);
    v3_scale(puff.up_ecef, 1 / v3_length(event->p_ecef), event->p_ecef);
    memcpy(puff.axis_ecef, event->d_ecef, sizeof puff.axis_ecef);
    puff.along_m = c->stretch * puff.scale * list->table->law[c->kind].radius_start_m;

    for (int i = 0; i < c->puffs; i++) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = draw(event->seed, 64 * which + i, k);
        if (!v3_normalize(d, d)) memcpy(d, puff.up_ecef, sizeof d);
        /* not into the ground: directions below the horizon are turned up */
        const double up = v3_dot(d, puff.up_ecef);
        if (up < 0) v3_add_scaled(d, d, -1.6 * up, puff.up_ecef);
        puff.seed = (uint32_t)mix(event->seed + (uint64_t)(64 * which + i));
        v3_add_scaled(puff.p_ecef, event->p_ecef, c->ahead * scale, event->d_ecef);
        v3_add_scaled(puff.p_ecef, puff.p_ecef, c->off * scale, d);
        if (puff.grounded) {
            double off[3];
            v3_sub(off, puff.p_ecef, event->p_ecef);
            puff.above_m = v3_dot(off, puff.up_ecef);
        }
        const double hard = 0.65 + 0.35 * draw(event->seed, 64 * which + i, 4);
        for (int k = 0; k < 3; k++)
            puff.throw_mps[k] = scale * (hard * c->throw_out_mps * d[k] + hard * c->throw_up_mps * puff.up_ecef[k] +
                                         c->throw_ahead_mps * event->d_ecef[k]);
        put(list, &puff);
    }
}

static void put_burst(PuffList *list, const EffectEvent *e, double t_s)
{
    /* bursts on the ground have less fire and more dust */
    static const Cloud ground[] = {
        {EFFECT_BURST_FLASH, 1, 0, 0, 0.2, 0, 0, 0, 1, 1, 1, 0},
        {EFFECT_FIREBALL, 4, 0, 0, 0.45, 4, 2, 0, 0.12, 0.6, 0.8, 0},
        {EFFECT_BURST_SMOKE, 5, 0.12, 0, 0.7, 3, 4, 0, 0.5, 0.7, 0.9, 0},
        {EFFECT_BURST_DUST, 9, 0.01, 0, 0.5, 6, 7, 0, 0.45, 0.8, 1, 0},
        {EFFECT_BURST_DUST, 7, 0.03, 0, 0.4, 9, 0.5, 0, 0.3, 0.5, 0.7, 0},
    };
    static const Cloud entity[] = {
        {EFFECT_BURST_FLASH, 1, 0, 0, 0.2, 0, 0, 0, 1, 1, 1, 0},
        {EFFECT_FIREBALL, 7, 0, 0, 0.6, 5, 2.5, 0, 0.14, 1, 1, 0},
        {EFFECT_BURST_SMOKE, 8, 0.15, 0, 0.9, 3, 3, 0, 0.5, 1, 1, 0},
        {EFFECT_BURST_DUST, 5, 0.03, 0, 0.6, 7, 0.6, 0, 0.35, 0.35, 0.8, 0},
    };
    static const Cloud air[] = {
        {EFFECT_BURST_FLASH, 1, 0, 0, 0, 0, 0, 0, 1, 1, 1, 0},
        {EFFECT_FIREBALL, 7, 0, 0, 0.55, 5, 0, 0, 0.14, 1, 1, 0},
        {EFFECT_BURST_SMOKE, 8, 0.12, 0, 0.9, 3.5, 0, 0, 0.5, 1, 1, 0},
    };
    static const Cloud kinetic[] = {
        {EFFECT_SPARKS, 3, 0, 0, 0.3, 6, 3, 0, 0.08, 1, 1, 0},
        {EFFECT_BURST_DUST, 4, 0.02, 0, 0.4, 4, 3, 0, 0.4, 0.4, 0.8, 0},
    };
    const Cloud *cloud = air;
    int          count = sizeof air / sizeof *air;

    if (effect_result_is_none(e->result)) return;
    if (e->kinetic) cloud = kinetic, count = sizeof kinetic / sizeof *kinetic;
    else if (effect_result_is_ground(e->result)) cloud = ground, count = sizeof ground / sizeof *ground;
    else if (result_is_entity(e->result)) cloud = entity, count = sizeof entity / sizeof *entity;
    else if (effect_result_is_water(e->result)) count = 1; /* only the flash; spray is not modelled */
    for (int c = 0; c < count; c++) put_cloud(list, e, c, cloud + c, t_s);
}

static void put_shot(PuffList *list, const EffectEvent *e, double t_s)
{
    static const Cloud gun[] = {
        {EFFECT_MUZZLE_FLASH, 1, 0, 0.35, 0.05, 0, 0, 0, 1, 1, 0.8, 2},
        {EFFECT_MUZZLE_FLASH, 3, 0.004, 1.1, 0.35, 4, 0, 25, 0.02, 1, 1, 0},
        {EFFECT_MUZZLE_SMOKE, 5, 0.012, 0.9, 0.5, 2.5, 0.5, 7, 0.3, 1, 1, 0},
    };
    static const Cloud missile[] = {
        {EFFECT_LAUNCH_FLASH, 2, 0, -0.5, 0.15, 0, 0, -6, 0.05, 1, 1, 2},
        {EFFECT_LAUNCH_SMOKE, 4, 0.02, -0.6, 0.3, 1.5, 0, -7, 0.35, 1, 1, 0},
        {EFFECT_LAUNCH_SMOKE, 2, 0.02, 0.6, 0.2, 1, 0, 3, 0.3, 0.5, 0.8, 0},
    };
    const Cloud *cloud = e->guided ? missile : gun;
    for (int c = 0; c < 3; c++) put_cloud(list, e, c, cloud + c, t_s);
}

/* Interval of emission of a kind of effect, and the age from which its puffs are thinned out. */
static void rhythm(double *interval_s, double *full_s, EffectKind kind)
{
    *interval_s = 0.25, *full_s = 2;
    if (kind == EFFECT_FLAME) *interval_s = 0.04, *full_s = 1e9;
    if (kind == EFFECT_MOTOR_SMOKE) *interval_s = 0.04, *full_s = 0.6;
    if (kind == EFFECT_ENGINE_SMOKE) *interval_s = 0.15;
    if (kind == EFFECT_CONTRAIL) *full_s = 3;
}

enum { most_halvings = 6 };

/* Old puffs of a trail are wide, so fewer are needed. From full_s on, with every doubling of age, every other puff
 * hands its mass to its neighbours: a puff with a number divisible by 2^level exists to the end of stage `level`. The
 * mass per second of trail is the same at every age. 0: removed. together: the number of puffs it represents. */
static double share_of(int64_t number, double age_s, double full_s, double *together)
{
    int level = 0;
    while (level < most_halvings && number % 2 == 0) number /= 2, level++;
    const double s = age_s > full_s ? fmin(log2(age_s / full_s), most_halvings) : 0;
    const int    stage = (int)s;
    const double f = s - stage, one = ldexp(1, stage);
    *together = one * (1 + f);
    if (level < stage) return 0;
    return level == stage && stage < most_halvings ? one * (1 - f) : one * (1 + f);
}

/* Groups of older kinds keep their numbers when there are more kinds. */
enum { kinds_of_groups = EFFECT_FLARE_FIRE + 1 };

static void put_source(PuffList *list, const EffectSource *source, double t_s)
{
    const EffectModel *law = &list->table->law[source->kind];
    const double       life_s = effect_life_s(list->table, source->kind, source->scale);
    double             interval_s, full_s;

    if (source->from_s > t_s || source->to_s + life_s <= t_s || source->to_s <= source->from_s) return;
    rhythm(&interval_s, &full_s, source->kind);
    EffectPuff    puff = {.kind = source->kind,
                          .owner = source->key,
                          .scale = source->scale,
                          .throw_s = 0.6,
                          .group = (uint32_t)mix(source->key * kinds_of_groups + source->kind)};
    const double  first_s = fmax(source->from_s, t_s - life_s), last_s = fmin(source->to_s, t_s);
    const int64_t first = (int64_t)ceil(first_s / interval_s), last = (int64_t)floor(last_s / interval_s);

    for (int64_t k = last; k >= first; k--) {
        const double let_go_s = (double)k * interval_s;
        double       together;
        if (!(let_go_s >= source->from_s && let_go_s < source->to_s) || let_go_s > t_s) continue;
        puff.age_s = t_s - let_go_s;
        const double share = share_of(k, puff.age_s, full_s, &together);
        if (!(share > 0) || !(puff.age_s < life_s)) continue;
        if (list->count >= list->capacity) { /* it is only counted */
            list->count++;
            continue;
        }

        const uint64_t seed = mix(source->key ^ mix((uint64_t)k + ((uint64_t)source->kind << 56)));
        Motion         motion;
        double         at_body[3], at_ecef[3];
        dead_reckon(&motion, &source->motion, clamp(let_go_s - source->motion_s, 0, source->hold_s));
        for (int i = 0; i < 3; i++) at_body[i] = source->at_body[i] + source->spread_body[i] * draw(seed, 0, i);
        m3_mul_v3(at_ecef, motion.r_ecef_from_body, at_body);
        v3_add(puff.p_ecef, motion.p_ecef, at_ecef);
        v3_scale(puff.up_ecef, 1 / v3_length(motion.p_ecef), motion.p_ecef);
        if (source->grounded) {
            double over[3];
            at_body[2] -= source->below_m;
            m3_mul_v3(over, motion.r_ecef_from_body, at_body);
            puff.grounded = true;
            puff.above_m = v3_dot(over, puff.up_ecef);
        }
        if (!v3_normalize(puff.axis_ecef, motion.v_ecef_mps)) memcpy(puff.axis_ecef, puff.up_ecef, sizeof puff.up_ecef);
        /* no puff is ahead of its source, since a missile would see its own smoke */
        puff.along_m = source->speed_mps * fmin(interval_s * together, puff.age_s);
        if (source->kind == EFFECT_FLAME) { /* tongues */
            memcpy(puff.axis_ecef, puff.up_ecef, sizeof puff.axis_ecef);
            puff.along_m = 0.8 * source->scale * (1 + 0.5 * draw(seed, 2, 1));
        }
        /* eddies move each puff to a side of its own, some more than others */
        for (int i = 0; i < 3; i++) puff.throw_mps[i] = 0.5 * source->scale * draw(seed, 1, i);
        const double strength = source->kind == EFFECT_FLAME ? 0.4 + 0.6 * (1 + draw(seed, 2, 0)) : 1;
        puff.seed = (uint32_t)seed;
        puff.mass_kg = law->mass_kg * interval_s * share * source->rate * source->scale * source->scale * strength;
        put(list, &puff);
    }
}

size_t effect_history_puffs(EffectPuff *out, size_t capacity, const EffectHistory *h, double t_s)
{
    PuffList list = {out, capacity, 0, &h->table};
    if (!(fabs(t_s) < effect_latest_s)) return 0;
    const uint64_t events = h->events < effect_event_capacity ? h->events : effect_event_capacity;
    const uint64_t sources = h->sources < effect_source_capacity ? h->sources : effect_source_capacity;

    for (uint64_t i = 1; i <= events; i++) {
        const EffectEvent *e = &h->event[(h->events - i) % effect_event_capacity];
        if (e->t_s > t_s || e->t_s + h->event_life_s < t_s) continue;
        if (e->detonation) put_burst(&list, e, t_s);
        else put_shot(&list, e, t_s);
    }
    for (uint64_t i = 1; i <= sources; i++)
        put_source(&list, &h->source[(h->sources - i) % effect_source_capacity], t_s);
    return list.count;
}

size_t effect_source_puffs(EffectPuff *out, size_t capacity, const EffectTable *table, const EffectSource *source,
                           double t_s)
{
    PuffList list = {out, capacity, 0, table};
    if (!(fabs(t_s) < effect_latest_s)) return 0;
    put_source(&list, source, t_s);
    return list.count;
}
