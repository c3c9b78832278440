/* render/scattering/signatures/signatures.c: finds signatures by their bins, and makes what is missing, in the
 * background too. */
#include "render/scattering/signatures/signatures.h"
#include "render/scattering/signatures/coarse.h"

#include <pthread.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

enum { most_kept = 4096, most_waiting = 256, most_planned = 256 };

/* One that is kept, or to be made. */
typedef struct Kept {
    int           model, damage;
    SignatureLook middle;
    double       *joint; /* [node_count] */
    Signature     signature;
    size_t        octets;
    uint64_t      used; /* number of the call */
} Kept;

/* The memory and tables to make one signature with; the background has its own. */
typedef struct Maker {
    RadarTarget **target; /* [models]; NULL: not met yet */
    TotalField    field;  /* memory that is used again */
} Maker;

/* All aspects of a model that are made when nothing else waits. */
typedef struct Planned {
    int  model, damage, next; /* next: of the bins */
    bool made[coarse_most_bins];
} Planned;

/* The thread that makes missing signatures. */
typedef struct Background {
    pthread_t         thread;
    bool              runs;
    pthread_mutex_t   lock; /* protects the following */
    pthread_cond_t    changed;
    bool              ends;
    int               waiting, done;
    Kept              wait[most_waiting], made[most_waiting]; /* wait: newest last */
    Kept              busy;                                   /* being made; joint NULL: none */
    SignatureCounters counters;                               /* made, rays, spent_s */
    Status            status;                                 /* the first failure */
    int               planned, bins;
    ScatterAntenna    bin[coarse_most_bins]; /* of every model that is planned */
    Planned           plan[most_planned];
} Background;

struct Signatures {
    SignaturesConfig      config;
    const Catalog        *catalog;
    const RadarMaterials *materials;
    int                   models;
    Maker                 maker;
    Background            background;
    NodePose             *pose; /* [most nodes] */
    double               *joint;
    int                   count;
    Kept                  kept[most_kept];
    size_t                octets;
    uint64_t              calls;
    SignatureCounters     counters;
};

static bool is_coarse(const Signatures *s) { return s->config.coarse_for_hz > 0; }

static bool same_antenna(const ScatterAntenna *a, const ScatterAntenna *b)
{
    return a->range_m == b->range_m && memcmp(a->u, b->u, sizeof a->u) == 0;
}

static bool same_look(const SignatureLook *a, const SignatureLook *b)
{
    return same_antenna(&a->tx, &b->tx) && same_antenna(&a->rx, &b->rx) && a->image[0] == b->image[0] &&
           a->image[1] == b->image[1] && memcmp(&a->plane, &b->plane, sizeof a->plane) == 0;
}

uint64_t signature_warp_seed(const Model *model)
{
    uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a */
    for (const char *c = model->name; *c; c++) hash = (hash ^ (uint8_t)*c) * 0x100000001b3u;
    return hash;
}

/* ---- what is kept ----------------------------------------------------------------------------------- */

static void kept_free(Kept *k)
{
    signature_free(&k->signature);
    free(k->joint);
    *k = (Kept){0};
}

static bool same(const Kept *a, const Kept *b, const Model *of)
{
    return a->model == b->model && a->damage == b->damage && same_look(&a->middle, &b->middle) &&
           memcmp(a->joint, b->joint, (size_t)of->node_count * sizeof *a->joint) == 0;
}

static void forget(Signatures *s, int i)
{
    s->octets -= s->kept[i].octets;
    kept_free(&s->kept[i]);
    s->kept[i] = s->kept[--s->count];
    s->kept[s->count] = (Kept){0};
}

/* Makes room for one more. */
static void make_room(Signatures *s)
{
    while (s->count > 0 && (s->count == most_kept || s->octets > s->config.most_octets)) {
        int oldest = 0;
        for (int i = 1; i < s->count; i++)
            if (s->kept[i].used < s->kept[oldest].used) oldest = i;
        forget(s, oldest);
        s->counters.dropped++;
    }
}

/* Takes over what it holds. */
static Kept *put(Signatures *s, Kept *one)
{
    make_room(s);
    Kept *k = &s->kept[s->count++];
    *k = *one;
    *one = (Kept){0};
    k->octets = (size_t)k->signature.count * sizeof *k->signature.centre + 256;
    k->used = s->calls;
    s->octets += k->octets;
    return k;
}

static Kept *find_kept(Signatures *s, const Kept *like)
{
    const Model *of = catalog_model(s->catalog, like->model);
    for (int i = 0; i < s->count; i++)
        if (same(&s->kept[i], like, of)) return &s->kept[i];
    return NULL;
}

static SignatureKey key_of(const Signatures *s, const Kept *k)
{
    return (SignatureKey){
        .model = catalog_model(s->catalog, k->model), .joint = k->joint, .damage = k->damage, .look = k->middle};
}

/* ---- making one ------------------------------------------------------------------------------------- */

static Status make(Kept *out, SignatureCounters *counters, const Signatures *s, Maker *maker, Pool *pool)
{
    const double         begun_s = wall_clock_s();
    const Model         *of = catalog_model(s->catalog, out->model);
    const SignatureLook *look = &out->middle;
    SignatureCells cells = signature_default_cells(s->config.frequency_hz, s->config.bandwidth_hz, s->config.aspect_rad,
                                                   s->config.interval_s);
    TubeConfig     config = tubes_default_config(s->config.frequency_hz);
    Status         status = STATUS_OK;
    config.rays_per_wavelength = s->config.rays_per_wavelength;
    config.splits = s->config.splits;
    config.warp_m = s->config.warp_m;
    config.warp_seed = signature_warp_seed(of);
    if (is_coarse(s)) coarse_tubes(&config, &cells);
    RadarTarget **target = &maker->target[out->model];
    if (!*target) status = radar_target_create(target, of, s->materials, s->config.isa);
    NodePose *pose = calloc((size_t)of->node_count + 1, sizeof *pose);
    if (!pose) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        model_pose(pose, of, out->joint);
        radar_target_pose(*target, pose, out->damage);
        status = total_field_trace(&maker->field, *target, &look->tx, &look->rx, &config, !is_coarse(s), pool);
    }
    if (status == STATUS_OK && (look->image[0] || look->image[1]))
        status = ground_hide(&maker->field, *target, &look->plane, look->image, pool);
    if (status == STATUS_OK) status = signature_make(&out->signature, &maker->field, *target, &cells);
    if (status == STATUS_OK && is_coarse(s))
        coarse_widen(&out->signature, s->config.frequency_hz, s->config.coarse_for_hz);
    free(pose);
    if (status != STATUS_OK) return status;
    counters->made++;
    counters->rays += (uint64_t)maker->field.hits.rays;
    counters->spent_s += wall_clock_s() - begun_s;
    if (s->config.store.keep) {
        const SignatureKey key = key_of(s, out);
        s->config.store.keep(s->config.store.user, &out->signature, &key);
    }
    return STATUS_OK;
}

static void maker_free(Maker *maker, int models)
{
    for (int m = 0; m < models && maker->target; m++) radar_target_destroy(maker->target[m]);
    total_field_free(&maker->field);
    free(maker->target);
    *maker = (Maker){0};
}

/* ---- in the background ------------------------------------------------------------------------------ */

/* The plan that has got least far, of those with bins left; NULL: none. */
static Planned *least_planned(Background *b)
{
    Planned *least = NULL;
    for (int i = 0; i < b->planned; i++) {
        Planned *p = &b->plan[i];
        while (p->next < b->bins && p->made[p->next]) p->next++;
        if (p->next < b->bins && (!least || p->next < least->next)) least = p;
    }
    return least;
}

/* Takes what is to be made next into b->busy: what was asked for, newest first, else what is planned. False: nothing.
 */
static bool take_next(Background *b, const Signatures *s)
{
    if (b->done == most_waiting) return false;
    if (b->waiting > 0) {
        b->busy = b->wait[--b->waiting];
        b->wait[b->waiting] = (Kept){0};
        return true;
    }
    const Planned *p = least_planned(b);
    if (!p) return false;
    double *joint = calloc((size_t)catalog_model(s->catalog, p->model)->node_count, sizeof *joint);
    if (!joint) b->status = STATUS_NO_MEMORY, b->planned = 0;
    else
        b->busy =
            (Kept){.model = p->model, .damage = p->damage, .joint = joint, .middle = signature_look(&b->bin[p->next])};
    return joint != NULL;
}

static bool same_planned(const Background *b, const Planned *p, int bin, const Kept *one)
{
    return p->model == one->model && p->damage == one->damage && same_antenna(&b->bin[bin], &one->middle.tx);
}

/* Crosses out what is made, or given up, of what is planned. */
static void cross_out(Background *b, const Kept *one)
{
    for (int i = 0; i < b->planned; i++)
        for (int bin = 0; bin < b->bins; bin++)
            if (same_planned(b, &b->plan[i], bin, one)) b->plan[i].made[bin] = true;
}

static void *run_background(void *user)
{
    Signatures *s = user;
    Background *b = &s->background;
    Maker       maker = {.target = calloc((size_t)s->models + 1, sizeof *maker.target)};
    if (s->config.nice > 0) setpriority(PRIO_PROCESS, (id_t)gettid(), s->config.nice); /* this thread's alone */
    thread_flush_denormals();
    pthread_mutex_lock(&b->lock);
    while (!b->ends) {
        if (!take_next(b, s)) {
            pthread_cond_wait(&b->changed, &b->lock);
            continue;
        }
        Kept              one = b->busy; /* ask() compares with b->busy meanwhile: its joints are only read */
        SignatureCounters counters = {0};
        pthread_mutex_unlock(&b->lock);
        const Status status = maker.target ? make(&one, &counters, s, &maker, NULL) : STATUS_NO_MEMORY;
        pthread_mutex_lock(&b->lock);
        b->busy = (Kept){0};
        cross_out(b, &one);
        if (status == STATUS_OK) b->made[b->done++] = one;
        else kept_free(&one);
        if (b->status == STATUS_OK) b->status = status;
        b->counters.made += counters.made;
        b->counters.rays += counters.rays;
        b->counters.spent_s += counters.spent_s;
    }
    pthread_mutex_unlock(&b->lock);
    maker_free(&maker, s->models);
    return NULL;
}

/* Takes in what has been made since. */
static Status collect(Signatures *s)
{
    Background *b = &s->background;
    if (!b->runs) return STATUS_OK;
    pthread_mutex_lock(&b->lock);
    for (int i = 0; i < b->done; i++) {
        if (find_kept(s, &b->made[i])) kept_free(&b->made[i]);
        else put(s, &b->made[i]);
    }
    if (b->done > 0) pthread_cond_signal(&b->changed);
    b->done = 0;
    const Status status = b->status;
    pthread_mutex_unlock(&b->lock);
    return status;
}

/* Takes over what it holds. The oldest is given up where there are too many. */
static void ask(Signatures *s, Kept *one)
{
    Background  *b = &s->background;
    const Model *of = catalog_model(s->catalog, one->model);
    pthread_mutex_lock(&b->lock);
    bool known = b->busy.joint && same(&b->busy, one, of);
    for (int i = 0; i < b->done && !known; i++) known = same(&b->made[i], one, of);
    for (int i = 0; i < b->waiting; i++) {
        if (!same(&b->wait[i], one, of)) continue;
        /* a signature that was asked for again is made next */
        const Kept again = b->wait[i];
        memmove(&b->wait[i], &b->wait[i + 1], (size_t)(b->waiting - i - 1) * sizeof *b->wait);
        b->wait[b->waiting - 1] = again;
        known = true;
        break;
    }
    if (!known) {
        if (b->waiting == most_waiting) {
            kept_free(&b->wait[0]);
            memmove(&b->wait[0], &b->wait[1], (most_waiting - 1) * sizeof *b->wait);
            b->waiting--;
        }
        b->wait[b->waiting++] = *one;
        *one = (Kept){0};
        pthread_cond_signal(&b->changed);
    }
    pthread_mutex_unlock(&b->lock);
    kept_free(one);
}

static void end_background(Signatures *s)
{
    Background *b = &s->background;
    if (!b->runs) return;
    pthread_mutex_lock(&b->lock);
    b->ends = true;
    pthread_cond_signal(&b->changed);
    pthread_mutex_unlock(&b->lock);
    pthread_join(b->thread, NULL);
    pthread_mutex_destroy(&b->lock);
    pthread_cond_destroy(&b->changed);
    for (int i = 0; i < b->waiting; i++) kept_free(&b->wait[i]);
    for (int i = 0; i < b->done; i++) kept_free(&b->made[i]);
    b->runs = false;
}

/* ---- the interface ---------------------------------------------------------------------------------- */

SignaturesConfig signatures_coarse(const SignaturesConfig *fine)
{
    SignaturesConfig config = *fine;
    config.frequency_hz = fmin(fine->frequency_hz, coarse_hz());
    config.interval_s *= fine->frequency_hz / config.frequency_hz; /* what spins is told apart as finely */
    config.splits = 0;
    config.coarse_for_hz = fine->frequency_hz;
    config.most_octets = (size_t)1 << 28;
    config.store = (SignatureStore){0};
    return config;
}

Status signatures_create(Signatures **out, const SignaturesConfig *config, const Catalog *catalog,
                         const RadarMaterials *materials)
{
    Signatures *s = calloc(1, sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    s->config = *config;
    s->catalog = catalog;
    s->materials = materials;
    s->models = catalog_model_count(catalog);
    int most = 1;
    for (int m = 0; m < s->models; m++) {
        const int nodes = catalog_model(catalog, m)->node_count;
        most = nodes > most ? nodes : most;
    }
    s->maker.target = calloc((size_t)s->models + 1, sizeof *s->maker.target);
    s->pose = calloc((size_t)most, sizeof *s->pose);
    s->joint = calloc((size_t)most, sizeof *s->joint);
    Status status = s->maker.target && s->pose && s->joint ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK && config->background) {
        Background *b = &s->background;
        pthread_mutex_init(&b->lock, NULL);
        pthread_cond_init(&b->changed, NULL);
        if (is_coarse(s)) b->bins = coarse_bins(b->bin);
        b->runs = pthread_create(&b->thread, NULL, run_background, s) == 0;
        if (!b->runs) status = STATUS_NO_MEMORY;
    }
    if (status == STATUS_OK) *out = s;
    else signatures_destroy(s);
    return status;
}

void signatures_destroy(Signatures *s)
{
    if (!s) return;
    end_background(s);
    while (s->count > 0) forget(s, s->count - 1);
    maker_free(&s->maker, s->models);
    free(s->pose);
    free(s->joint);
    free(s);
}

/* Without the ground. */
static void coarse_look_bin(SignatureLook *middle, const SignatureLook *look)
{
    memset(middle, 0, sizeof *middle);
    coarse_bin(&middle->tx, &look->tx);
    coarse_bin(&middle->rx, &look->rx);
}

Status signatures_find(const Signature **out, Signatures *s, int model, const double *joint, int damage,
                       const SignatureLook *look, Pool *pool)
{
    const Model *of = catalog_model(s->catalog, model);
    Kept         one = {.model = model, .damage = damage, .joint = s->joint};
    const bool   posed = joint && !is_coarse(s);
    for (int n = 0; n < of->node_count; n++) s->joint[n] = posed && of->node[n].roll_radius_m == 0 ? joint[n] : 0;
    model_pose(s->pose, of, s->joint);
    if (is_coarse(s)) coarse_look_bin(&one.middle, look);
    else signature_look_bin(&one.middle, look, s->config.aspect_rad);
    s->calls++;
    Status status = collect(s);
    if (status != STATUS_OK) return status;
    Kept *k = find_kept(s, &one);
    if (k) {
        k->used = s->calls;
        s->counters.reused++;
        *out = &k->signature;
        return STATUS_OK;
    }
    one.joint = malloc((size_t)of->node_count * sizeof *one.joint);
    if (!one.joint) return STATUS_NO_MEMORY;
    memcpy(one.joint, s->joint, (size_t)of->node_count * sizeof *one.joint);
    const SignatureKey key = key_of(s, &one);
    if (s->config.store.fetch && s->config.store.fetch(s->config.store.user, &one.signature, &key)) {
        s->counters.fetched++;
    } else if (s->background.runs) {
        s->counters.missing++;
        ask(s, &one);
        *out = NULL;
        return STATUS_OK;
    } else {
        status = make(&one, &s->counters, s, &s->maker, pool);
    }
    if (status == STATUS_OK) *out = &put(s, &one)->signature;
    kept_free(&one);
    return status;
}

const NodePose *signatures_pose(const Signatures *s) { return s->pose; }

SignatureCounters signatures_counters(const Signatures *s)
{
    SignatureCounters c = s->counters;
    Background       *b = (Background *)(uintptr_t)&s->background;
    if (!b->runs) return c;
    pthread_mutex_lock(&b->lock);
    c.made += b->counters.made;
    c.rays += b->counters.rays;
    c.spent_s += b->counters.spent_s;
    pthread_mutex_unlock(&b->lock);
    return c;
}

int signatures_waiting(const Signatures *s)
{
    Background *b = (Background *)(uintptr_t)&s->background;
    if (!b->runs) return 0;
    pthread_mutex_lock(&b->lock);
    int  waiting = b->waiting;
    bool busy = b->busy.joint != NULL; /* with one that no plan counts */
    for (int i = 0; i < b->planned; i++)
        for (int bin = 0; bin < b->bins; bin++) {
            waiting += !b->plan[i].made[bin];
            if (busy && !b->plan[i].made[bin]) busy = !same_planned(b, &b->plan[i], bin, &b->busy);
        }
    waiting += busy;
    pthread_mutex_unlock(&b->lock);
    return waiting;
}

Status signatures_prepare(Signatures *s, int model, int damage)
{
    Background  *b = &s->background;
    const Status status = collect(s);
    if (!b->runs || !is_coarse(s) || status != STATUS_OK) return status;
    pthread_mutex_lock(&b->lock);
    bool known = b->planned == most_planned; /* more are made when they are asked for */
    for (int i = 0; i < b->planned && !known; i++) known = b->plan[i].model == model && b->plan[i].damage == damage;
    if (!known) {
        b->plan[b->planned++] = (Planned){.model = model, .damage = damage};
        pthread_cond_signal(&b->changed);
    }
    pthread_mutex_unlock(&b->lock);
    return STATUS_OK;
}
