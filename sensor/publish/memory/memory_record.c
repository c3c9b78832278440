/* sensor/publish/memory/memory_record.c: a frame's record and targets as they stand in shared memory. */
#include "sensor/publish/memory/memory_record.h"

#include "sensor/publish/target_class.h"

/* Of wall_clock_s, which is CLOCK_MONOTONIC. A double holds it to 0.1 us for four months of uptime. */
static int64_t ns(double wall_s) { return wall_s > 0 ? (int64_t)llround(1e9 * wall_s) : 0; }

static void fill_target(PitviperMemoryTarget *out, const TargetRecord *t)
{
    char type[dis_type_text_size];
    dis_entity_type_text(type, t->type);
    *out = (PitviperMemoryTarget){
        .site = t->id.site, .application = t->id.application, .entity = t->id.entity,
        .class_number = (uint16_t)t->class_number, .plane_value = (uint32_t)t->plane_value,
        .flags = (uint32_t)t->occluder, .range_m = t->range_m,
        .closing_mps = t->closing_mps, .aspect_rad = t->aspect_rad, .depression_rad = t->depression_rad,
        .los_az_rad = t->los_az_rad, .los_el_rad = t->los_el_rad, .pixels = t->pixels,
        .visible_fraction = t->visible_fraction, .age_s = t->age_s, .position_error_m = t->position_error_m};
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
        out->band[b] = (PitviperMemoryTargetBand){in->contrast_k, in->dt_rss_k, in->contrast, in->snr,
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
        if (r->target[i].pixels > 0 || hidden-- > 0)
            fill_target(&out[count++], &r->target[i]);
    return count;
}

void memory_record(PitviperMemoryRecord *out, PitviperMemoryTarget *targets, int room, const Frame *frame)
{
    const FrameRecord *r    = &frame->record;
    const Provenance  *p    = &frame->provenance;
    const View        *view = &frame->request.view;
    *out = (PitviperMemoryRecord){
        .frame = frame->number, .flags = (r->gimbal_at_limit ? 1u : 0) | (frame->buried ? 2u : 0),
        .time_s = frame->time_s, .unix_us = llround(1e6 * frame->unix_s), .hfov_rad = r->hfov_rad,
        .vfov_rad = 2 * atan(0.5 * view->height / view->focal_px), .focal_px = view->focal_px,
        .arrived_ns = ns(frame->times.arrived_s), .begun_ns = ns(p->begun_s),
        .posed_ns = ns(frame->times.posed_s), .rendered_ns = ns(p->rendered_s), .seed = p->seed,
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
    out->target_count     = (uint32_t)fill_targets(targets, room, r);
    out->targets_left_out = (uint32_t)r->target_count - out->target_count;
}
