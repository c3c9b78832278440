/* render/radar/total_field.c: ray tubes and edges of one look together. */
#include "render/radar/total_field.h"

typedef struct Sight {
    const PosedEntity    *entity;
    const ScatterAntenna *antenna[2];
} Sight;

static bool sees(void *user, const double p[3], int antenna)
{
    const Sight *sight = user;
    double       way[3];
    scatter_path(way, sight->antenna[antenna], p);
    return !parts_occluded(sight->entity, p, way, false);
}

Status total_field_trace(TotalField *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                         const TubeConfig *config, bool edges, Pool *pool)
{
    out->edges.count = 0;
    const Status status = tubes_trace(&out->hits, target, tx, rx, config, pool);
    if (status != STATUS_OK || !edges || target->wedge_count == 0) return status;
    Sight            sight = {&target->entity, {tx, rx}};
    const EdgeConfig edge = {.k_per_m = 1.5 * 2 * pi_rad * config->frequency_hz / light_mps,
                             .sample_m = fmin(0.05, target->entity.radius_m / 64), .clear_m = 1e-4, .visible = sees,
                             .user = &sight};
    return edge_segments(&out->edges, target->wedge, target->wedge_count, tx, rx, &edge);
}

/* A segment as moved antennas see it: its path changes, its amplitude hardly. */
static double moved_path_m(const EdgeSegment *s, const TotalField *field, const ScatterAntenna *tx,
                           const ScatterAntenna *rx)
{
    double way[3];
    return s->path_m + (scatter_path(way, tx, s->p) - scatter_path(way, &field->hits.tx, s->p)) +
           (scatter_path(way, rx, s->p) - scatter_path(way, &field->hits.rx, s->p));
}

Status total_field_sweep(ScatterMatrix *s, int count, double first_hz, double step_hz, const TotalField *field,
                         const ScatterAntenna *tx, const ScatterAntenna *rx, Pool *pool)
{
    const Status status = field_sweep(s, count, first_hz, step_hz, &field->hits, tx, rx, pool);
    for (int i = 0; i < field->edges.count && status == STATUS_OK; i++) {
        EdgeSegment        one = field->edges.segment[i];
        const EdgeSegments alone = {.count = 1, .segment = &one};
        if (tx || rx) one.path_m = moved_path_m(&one, field, tx ? tx : &field->hits.tx, rx ? rx : &field->hits.rx);
        for (int f = 0; f < count; f++)
            edge_segments_field(&s[f], &alone, 2 * pi_rad * (first_hz + f * step_hz) / light_mps);
    }
    return status;
}

void total_field_free(TotalField *field)
{
    tubes_free(&field->hits);
    edge_segments_destroy(&field->edges);
}
