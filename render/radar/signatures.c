/* render/radar/signatures.c: see signatures.h. */
#include "render/radar/signatures.h"

#include <stdlib.h>

enum { most_lists = 256 };

typedef struct Signature {
    int            model, damage;
    ScatterAntenna middle;
    double        *joint;     /* [node_count] */
    TotalField     field;
    size_t         octets;
    uint64_t       used;      /* number of the call */
} Signature;

struct Signatures {
    SignatureConfig       config;
    const Catalog        *catalog;
    const RadarMaterials *materials;
    RadarTarget         **target;  /* [models]; NULL: not met yet */
    int                   models;
    NodePose             *pose;    /* [most nodes] */
    double               *joint;
    int                   count;
    Signature             list[most_lists];
    size_t                octets;
    uint64_t              calls;
    const RadarTarget    *found;
    SignatureCounters     counters;
};

void signature_bin(ScatterAntenna *middle, const ScatterAntenna *antenna, double aspect_rad)
{
    const double elevation = asin(clamp(antenna->u[2], -1, 1)), azimuth = atan2(antenna->u[1], antenna->u[0]);
    const double el = clamp(aspect_rad * (floor(elevation / aspect_rad) + 0.5), -0.5 * pi_rad, 0.5 * pi_rad);
    const double bins = fmax(1, nearbyint(2 * pi_rad * cos(el) / aspect_rad)), width = 2 * pi_rad / bins;
    const double az = width * (fmin(floor((azimuth + pi_rad) / width), bins - 1) + 0.5) - pi_rad;
    middle->u[0] = cos(el) * cos(az);
    middle->u[1] = cos(el) * sin(az);
    middle->u[2] = sin(el);
    middle->range_m = isinf(antenna->range_m) ? INFINITY : exp2(nearbyint(4 * log2(antenna->range_m)) / 4);
}

Status signatures_create(Signatures **out, const SignatureConfig *config, const Catalog *catalog,
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
    s->target = calloc((size_t)s->models + 1, sizeof *s->target);
    s->pose = calloc((size_t)most, sizeof *s->pose);
    s->joint = calloc((size_t)most, sizeof *s->joint);
    if (!s->target || !s->pose || !s->joint) {
        signatures_destroy(s);
        return STATUS_NO_MEMORY;
    }
    *out = s;
    return STATUS_OK;
}

static void forget(Signatures *s, int i)
{
    s->octets -= s->list[i].octets;
    total_field_free(&s->list[i].field);
    free(s->list[i].joint);
    s->list[i] = s->list[--s->count];
    s->list[s->count] = (Signature){0};
}

void signatures_destroy(Signatures *s)
{
    if (!s) return;
    while (s->count > 0) forget(s, s->count - 1);
    for (int m = 0; m < s->models && s->target; m++) radar_target_destroy(s->target[m]);
    free(s->target);
    free(s->pose);
    free(s->joint);
    free(s);
}

static size_t octets_of(const TotalField *field)
{
    const TubeHits *hits = &field->hits;
    return (size_t)field->edges.capacity * sizeof *field->edges.segment +
           hits->capacity * (sizeof(double) + (2 + 8 + 6) * sizeof(float) + sizeof(uint8_t) + sizeof(uint16_t));
}

/* Makes room for one more list. */
static void make_room(Signatures *s)
{
    while (s->count > 0 && (s->count == most_lists || s->octets > s->config.most_octets)) {
        int oldest = 0;
        for (int i = 1; i < s->count; i++)
            if (s->list[i].used < s->list[oldest].used) oldest = i;
        forget(s, oldest);
        s->counters.dropped++;
    }
}

static Status make(Signature *out, Signatures *s, int model, const Model *of, int damage, const ScatterAntenna *middle,
                   Pool *pool)
{
    const double begun_s = wall_clock_s();
    TubeConfig   config = tubes_default_config(s->config.frequency_hz);
    config.rays_per_wavelength = s->config.rays_per_wavelength;
    config.splits = s->config.splits;
    config.warp_m = s->config.warp_m;
    config.warp_seed = (uint64_t)model;
    *out = (Signature){.model = model, .damage = damage, .middle = *middle};
    out->joint = malloc((size_t)of->node_count * sizeof *out->joint);
    if (!out->joint) return STATUS_NO_MEMORY;
    memcpy(out->joint, s->joint, (size_t)of->node_count * sizeof *out->joint);
    const Status status = total_field_trace(&out->field, s->target[model], middle, middle, &config, true, pool);
    s->counters.made++;
    s->counters.rays += (uint64_t)out->field.hits.rays;
    s->counters.spent_s += wall_clock_s() - begun_s;
    out->octets = octets_of(&out->field);
    return status;
}

Status signatures_find(const TotalField **out, Signatures *s, int model, const double *joint, int damage,
                       const ScatterAntenna *antenna, Pool *pool)
{
    const Model   *of = catalog_model(s->catalog, model);
    ScatterAntenna middle;
    Status         status = STATUS_OK;
    if (!s->target[model]) status = radar_target_create(&s->target[model], of, s->materials, s->config.isa);
    if (status != STATUS_OK) return status;
    for (int n = 0; n < of->node_count; n++) s->joint[n] = joint && of->node[n].roll_radius_m == 0 ? joint[n] : 0;
    model_pose(s->pose, of, s->joint);
    radar_target_pose(s->target[model], s->pose, damage);
    s->found = s->target[model];
    signature_bin(&middle, antenna, s->config.aspect_rad);
    s->calls++;
    for (int i = 0; i < s->count; i++) {
        Signature *l = &s->list[i];
        if (l->model != model || l->damage != damage || l->middle.range_m != middle.range_m ||
            memcmp(l->middle.u, middle.u, sizeof middle.u) != 0 ||
            memcmp(l->joint, s->joint, (size_t)of->node_count * sizeof *s->joint) != 0)
            continue;
        l->used = s->calls;
        s->counters.reused++;
        *out = &l->field;
        return STATUS_OK;
    }
    make_room(s);
    Signature *l = &s->list[s->count];
    status = make(l, s, model, of, damage, &middle, pool);
    if (status != STATUS_OK) {
        total_field_free(&l->field);
        free(l->joint);
        *l = (Signature){0};
        return status;
    }
    l->used = s->calls;
    s->octets += l->octets;
    s->count++;
    *out = &l->field;
    return STATUS_OK;
}

const RadarTarget       *signatures_target(const Signatures *s) { return s->found; }
const SignatureCounters *signatures_counters(const Signatures *s) { return &s->counters; }
