/* sensor/publish/memory/consume_memory.c: the consumer that writes each frame, its record and its targets into a ring
 * in shared memory. */
#include "sensor/publish/memory/consume_memory.h"
#include "sensor/frame/target_record.h"
#include "sensor/publish/memory/memory_ring_private.h"

#include <pitviper_memory.h>
#include <stdlib.h>

/* ---- the record and the targets of a frame ------------------------------------------------------- */

/* Of wall_clock_s, which is CLOCK_MONOTONIC. A double holds it to 0.1 us for four months of uptime. */
static int64_t ns(double wall_s) { return wall_s > 0 ? (int64_t)llround(1e9 * wall_s) : 0; }

static void fill_target(PitviperMemoryTarget *out, const TargetRecord *t)
{
    char type[dis_type_text_size];
    dis_entity_type_text(type, t->type);
    *out = (PitviperMemoryTarget){.site = t->id.site,
                                  .application = t->id.application,
                                  .entity = t->id.entity,
                                  .class_number = (uint16_t)t->class_number,
                                  .plane_value = (uint32_t)t->plane_value,
                                  .flags = (uint32_t)t->occluder,
                                  .range_m = t->range_m,
                                  .closing_mps = t->closing_mps,
                                  .aspect_rad = t->aspect_rad,
                                  .depression_rad = t->depression_rad,
                                  .los_az_rad = t->los_az_rad,
                                  .los_el_rad = t->los_el_rad,
                                  .pixels = t->pixels,
                                  .visible_fraction = t->visible_fraction,
                                  .age_s = t->age_s,
                                  .position_error_m = t->position_error_m};
    snprintf(out->class_name, sizeof out->class_name, "%s", target_class_name(t->class_number));
    memcpy(out->marking, t->marking, strlen(t->marking));
    snprintf(out->type, sizeof out->type, "%s", type);
    for (int k = 0; k < 4; k++) out->box[k] = t->box[k];
    memcpy(out->amodal_box, t->amodal_box, sizeof out->amodal_box);
    memcpy(out->los_rate_rps, t->los_rate_rps, sizeof out->los_rate_rps);
    memcpy(out->boresight_error_rad, t->boresight_error_rad, sizeof out->boresight_error_rad);
    memcpy(out->p_ecef, t->p_ecef, sizeof out->p_ecef);
    memcpy(out->v_ecef, t->v_ecef_mps, sizeof out->v_ecef);
    for (int b = 0; b < BAND_COUNT; b++) {
        const TargetBand *in = &t->band[b];
        out->band[b] = (PitviperMemoryTargetBand){in->contrast_k,     in->dt_rss_k,           in->contrast, in->snr,
                                                  in->intensity_w_sr, in->veil_transmittance, {0, 0}};
    }
}

/* Returns how many there are. */
static int fill_targets(PitviperMemoryTarget *out, int room, const FrameRecord *r)
{
    int       count = 0, visible = 0;
    const int all = r->target_count;
    for (int i = 0; i < all; i++) visible += r->target[i].pixels > 0;
    int hidden = room - visible; /* those for which there is room beside the visible ones */
    for (int i = 0; i < all && count < room; i++)
        if (r->target[i].pixels > 0 || hidden-- > 0) fill_target(&out[count++], &r->target[i]);
    return count;
}

/* All but lock, sequence and written_ns. targets: [room]; without truth none are filled in. Where there is not room for
 * all targets, visible ones come first; otherwise they are in the order of truth.jsonl. */
static void fill_record(PitviperMemoryRecord *out, PitviperMemoryTarget *targets, int room, const Frame *frame)
{
    const FrameRecord *r = &frame->record;
    const Provenance  *p = &frame->provenance;
    const View        *view = &frame->request.view;
    *out = (PitviperMemoryRecord){.frame = frame->number,
                                  .flags = (r->gimbal_at_limit ? 1u : 0) | (frame->buried ? 2u : 0),
                                  .time_s = frame->time_s,
                                  .unix_us = llround(1e6 * frame->unix_s),
                                  .hfov_rad = r->hfov_rad,
                                  .vfov_rad = 2 * atan(0.5 * view->height / view->focal_px),
                                  .focal_px = view->focal_px,
                                  .arrived_ns = ns(frame->times.arrived_s),
                                  .begun_ns = ns(p->begun_s),
                                  .posed_ns = ns(frame->times.posed_s),
                                  .rendered_ns = ns(p->rendered_s),
                                  .seed = p->seed,
                                  .datagrams = p->datagrams};
    memcpy(out->p_ecef, r->p_eye_ecef, sizeof out->p_ecef);
    memcpy(out->v_ecef, r->v_eye_mps, sizeof out->v_ecef);
    memcpy(out->r_ecef_from_cam, r->r_ecef_from_cam, sizeof out->r_ecef_from_cam);
    memcpy(out->r_ecef_from_body, r->r_ecef_from_body, sizeof out->r_ecef_from_body);
    for (int k = 0; k < 3; k++) out->boresight_ecef[k] = r->r_ecef_from_cam[3 * k + 2];
    if (view_has_lens(view)) {
        const Lens  *l = &view->lens;
        const double opencv[5] = {l->k[0], l->k[1], l->p[0], l->p[1], l->k[2]};
        memcpy(out->distortion, opencv, sizeof out->distortion);
    }
    memcpy(out->scene_rate_px_s, r->scene_rate_px_s, sizeof out->scene_rate_px_s);
    snprintf(out->host, sizeof out->host, "%s", frame->host);
    snprintf(out->config_sha256, sizeof out->config_sha256, "%s", p->config_sha256 ? p->config_sha256 : "");
    if (room == 0) return;
    out->target_count = (uint32_t)fill_targets(targets, room, r);
    out->targets_left_out = (uint32_t)r->target_count - out->target_count;
}

/* ---- the consumer -------------------------------------------------------------------------------- */

/* Targets in a slot, 576 octets each; those in the field of view, so most runs have fewer. */
enum { target_room = 256 };

typedef struct Memory {
    Consumer    consumer;
    MemoryRing *ring;
    char        name[memory_name_size];
    uint64_t   *unnamed, own_unnamed; /* frames; own: counts where the caller gave no place for it */
    bool        counts;
    int         room; /* for targets; 0: kind sensor */
    int         plane_count;
    Band        band[pitviper_memory_planes_most]; /* of each plane */
    int         width, height;
} Memory;

/* ---- the planes, before there is a frame ---------------------------------------------------------- */

static void describe(MemoryRingOf *ring, Memory *m, const MemoryOf *of)
{
    for (int k = 0; k < plane_row_count; k++) {
        const PlaneRow *row = &plane_rows[k];
        const Band      band = plane_band(row);
        if (row->kind != PLANE_RADIANCE || !plane_of_bands(row, of->bands, config_optical(of->config)) ||
            (m->counts && !of->count_bits[band]))
            continue;
        PitviperMemoryPlane *p = &ring->plane[ring->plane_count];
        *p = (PitviperMemoryPlane){.band = (uint32_t)band,
                                   .width = (uint32_t)m->width,
                                   .height = (uint32_t)m->height,
                                   .type = m->counts ? PITVIPER_PLANE_UINT16 : PITVIPER_PLANE_FLOAT32,
                                   .bits = m->counts ? (uint32_t)of->count_bits[band] : 0};
        snprintf(p->band_name, sizeof p->band_name, "%s", plane_group(row));
        snprintf(p->name, sizeof p->name, "%s", row->name);
        snprintf(p->unit, sizeof p->unit, "%s", m->counts ? "counts" : row->unit);
        m->band[ring->plane_count++] = band;
    }
    m->plane_count = ring->plane_count;
}

/* ---- frame by frame --------------------------------------------------------------------------------- */

static int radiance_of(const void *values[pitviper_memory_planes_most], const Memory *m, const Frame *frame)
{
    int count = 0;
    for (int i = 0; i < frame->seen.plane_count; i++) {
        const FrameArray *p = &frame->seen.plane[i];
        if (p->kind != PLANE_RADIANCE || p->type != PLANE_F32) continue;
        if (count == m->plane_count || p->size[0] != m->height || p->size[1] != m->width) return -1;
        values[count++] = p->values;
    }
    return count;
}

static int counts_of(const void *values[pitviper_memory_planes_most], const Memory *m, const Frame *frame)
{
    int count = 0;
    for (; count < m->plane_count; count++) {
        const Band          band = m->band[count];
        const FrameDisplay *display = &frame->display[band];
        int                 channel = 0;
        for (int k = 0; k < count; k++) channel += m->band[k] == band;
        if (channel >= display->planes || !display->counts[channel]) return -1;
        values[count] = display->counts[channel];
    }
    return count;
}

static Status put(Consumer *consumer, Frame *frame)
{
    Memory     *m = (Memory *)consumer;
    const void *values[pitviper_memory_planes_most];
    const int   count = m->counts ? counts_of(values, m, frame) : radiance_of(values, m, frame);
    if (count != m->plane_count) {
        log_error("memory: frame %d does not have the planes that the ring was made for", frame->number);
        return STATUS_BAD_VALUE;
    }
    fill_record(memory_ring_record(m->ring), memory_ring_targets(m->ring), m->room, frame);
    memory_ring_put(m->ring, values);
    if (!memory_ring_is_named(m->ring) && (*m->unnamed)++ == 0)
        log_warn(
            "memory: /dev/shm/%s was removed or replaced by another program: who opens it now does not see these frames, "
            "who had opened it before does; end this node and start it anew, perhaps with another --memory",
            m->name);
    return STATUS_OK;
}

static Status close_memory(Consumer *consumer)
{
    Memory *m = (Memory *)consumer;
    memory_ring_close(m->ring);
    free(m);
    return STATUS_OK;
}

void memory_name(char out[memory_name_size], const Config *config, const char *host)
{
    snprintf(out, memory_name_size, "%s%s%s", config->publish.memory, host ? "-" : "", host ? host : "");
    for (char *c = out; *c; c++)
        if (*c == ':') *c = '-';
}

Status consume_memory(Consumer **out, const MemoryOf *of)
{
    const Config *config = of->config;
    Memory       *m = calloc(1, sizeof *m);
    if (!m) return STATUS_NO_MEMORY;
    const bool truth = config->publish.memory_record == MEMORY_RECORD_TRUTH;
    m->counts = config->publish.memory_planes == MEMORY_PLANES_COUNTS;
    m->room = truth ? target_room : 0;
    m->width = config->sensor.width_px;
    m->height = config->sensor.height_px;
    m->consumer = (Consumer){.wants = (truth ? WANT_TARGETS : 0) | (m->counts ? WANT_COUNTS : 0),
                             .put = put,
                             .close = close_memory,
                             .name = "memory"};
    memory_name(m->name, config, of->host);
    m->unnamed = of->unnamed ? of->unnamed : &m->own_unnamed;
    MemoryRingOf ring = {.name = m->name,
                         .slots = config->publish.memory_slots,
                         .target_room = m->room,
                         .truth = truth,
                         .host = of->host,
                         .config_sha256 = of->config_sha256,
                         .detections_port = config->publish.detections_port};
    describe(&ring, m, of);
    Status status = STATUS_BAD_VALUE;
    if (m->plane_count > 0) status = memory_ring_create(&m->ring, &ring);
    else log_error("memory: publish.memory_planes: counts: no band has a sensor; choose one with sensor.preset");
    if (status == STATUS_OK) *out = &m->consumer;
    else free(m);
    if (status == STATUS_OK)
        log_print("memory: /dev/shm/%s: %d planes of %d x %d, %d slots, %.1f MB; to see them: "
                  "etc/examples/read_memory.py %s\n",
                  m->name, m->plane_count, m->width, m->height, ring.slots, 1e-6 * (double)memory_ring_size(m->ring),
                  m->name);
    return status;
}
