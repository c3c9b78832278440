/* sensor/verify/saved_frame/saved_again.c: renders the picture of a frame file again, measures its radar again,
 * hashes plane by plane and compares. */
#include "sensor/verify/saved_frame/saved_again.h"
#include "sensor/frame/frame_world.h"
#include "sensor/frame/plane.h"
#include "sensor/frame/radar_record.h"

/* ---- results ------------------------------------------------------------------------------ */

/* Reads a value of a plane, and of a complex plane its magnitude. */
static double value_at(const Plane *plane, size_t i)
{
    const float *part = plane->values;
    switch (plane->type) {
    case PLANE_C64:
        return hypot((double)part[2 * i], (double)part[2 * i + 1]);
    case PLANE_F32:
        return (double)((const float *)plane->values)[i];
    case PLANE_U32:
        return ((const uint32_t *)plane->values)[i];
    case PLANE_U8:
        return ((const uint8_t *)plane->values)[i];
    case PLANE_F64:
        break;
    }
    return ((const double *)plane->values)[i];
}

static void measure(SavedPlane *out, const Plane *plane)
{
    const size_t count = (size_t)plane->width * (size_t)plane->height;
    double       sum = 0;
    out->finite = 0;
    out->low = INFINITY;
    out->high = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double value = value_at(plane, i);
        if (!isfinite(value)) continue;
        out->finite++;
        sum += value;
        out->low = fmin(out->low, value);
        out->high = fmax(out->high, value);
    }
    out->mean = out->finite > 0 ? sum / out->finite : 0;
}

Status saved_made(SavedMade *out, const FrameArray *from, int count)
{
    Plane plane[frame_max_planes] = {0};
    *out = (SavedMade){.plane_count = count};
    for (int i = 0; i < count; i++) plane[i] = frame_plane(out->plane[i].name, &from[i]);
    Status status = plane_hash(out->sha256, plane, count);
    for (int i = 0; i < count && status == STATUS_OK; i++) {
        SavedPlane *p = &out->plane[i];
        measure(p, &plane[i]);
        status = plane_hash(p->sha256, &plane[i], 1);
    }
    return status;
}

/* ---- rendered again --------------------------------------------------------------------------------- */

Status saved_again(SavedAgain *out, const SavedStage *stage, bool no_skip)
{
    const SavedFrame *file = stage->file;
    const World      *world = stage->world;
    RenderRequest     request = file->request;
    const double     *p_ecef = file->eye.p_ecef;
    const FrameEye    at = {file->unix_s + file->time_s,
                            {p_ecef[0], p_ecef[1], p_ecef[2]},
                            &request.view,
                            request.bands,
                            &stage->snapshot->marks};
    FrameLight        light;
    request.skips_off = no_skip ? skips_all_off : 0;
    Status status = frame_light(&light, world, stage->config, &at, stage->pool, stage->arena);
    if (status == STATUS_OK)
        status = render(&out->picture, world, stage->snapshot, &request, &light.air, stage->pool, stage->arena);
    if (status != STATUS_OK) return status;
    out->sun = light.sun;
    if (out->picture.normal[0]) frame_turn_normals(&out->picture, light.r_host_from_enu);
    FrameArray plane[frame_max_planes];
    return saved_made(&out->made, plane, frame_planes(plane, &out->picture, &request));
}

/* ---- compared ----------------------------------------------------------------------------------- */

static const SavedPlane *plane_named(const SavedPlane *plane, int count, const char *name)
{
    for (int i = 0; i < count; i++)
        if (strcmp(plane[i].name, name) == 0) return &plane[i];
    return NULL;
}

int saved_differences(const SavedFrame *file, const SavedMade *made, bool said)
{
    int different = 0;
    for (int i = 0; i < file->plane_count; i++) {
        const SavedPlane *was = &file->plane[i], *is = plane_named(made->plane, made->plane_count, was->name);
        if (is && strcmp(is->sha256, was->sha256) == 0) continue;
        different++;
        if (!said) continue;
        if (!is) {
            log_error("frame: %s is not among the planes that this request gives here", was->name);
            continue;
        }
        log_error("frame: %s differs: mean %.9g, was %.9g; from %.9g to %.9g, was %.9g to %.9g; %.0f finite values, "
                  "were %.0f",
                  was->name, is->mean, was->mean, is->low, is->high, was->low, was->high, is->finite, was->finite);
    }
    for (int i = 0; i < made->plane_count; i++) {
        if (plane_named(file->plane, file->plane_count, made->plane[i].name)) continue;
        different++;
        if (said) log_error("frame: %s is not in the file", made->plane[i].name);
    }
    return different + (different == 0 && strcmp(made->sha256, file->frame_sha256) != 0);
}

/* ---- the radar ----------------------------------------------------------------------------------- */

Status saved_radar_gather(SavedFrame *file, const RadarFrame *radar, double *joint)
{
    SavedRadar *r = &file->radar;
    file->measured = true;
    *r = (SavedRadar){.has_aim = !isnan(radar->aim_m),
                      .aim_m = isnan(radar->aim_m) ? 0 : radar->aim_m,
                      .number = radar->number,
                      .joint_count = file->snapshot.node_count,
                      .joint = joint,
                      .detections = radar->detections_in_all,
                      .coarse = radar->coarse};
    memcpy(r->v_enu_mps, radar->v_enu_mps, sizeof r->v_enu_mps);
    memcpy(r->aim_v_enu_mps, radar->aim_v_enu_mps, sizeof r->aim_v_enu_mps);
    return radar_sha256(r->map_sha256, radar, 0, radar_arrays_most); /* with a scan its pictures too */
}

Status saved_radar_again(const RadarFrame **out, SeekerRadar *radar, const SavedStage *stage, const Picture *picture)
{
    const SavedFrame *file = stage->file;
    const SavedRadar *r = &file->radar;
    const Weather     weather = frame_weather_at(stage->config, stage->world, file->unix_s + file->time_s);
    RadarScene        scene = {.world = stage->world,
                               .refraction = file->request.refraction,
                               .snapshot = stage->snapshot,
                               .joint = r->joint,
                               .view = &file->request.view,
                               .hidden = file->request.hidden_entity,
                               .reference_m = r->has_aim ? r->aim_m : NAN,
                               .t_s = file->time_s,
                               .weather = &weather,
                               .number = r->number,
                               .coarse = r->coarse,
                               .range_m = picture->range_m,
                               .entity = picture->entity};
    memcpy(scene.v_enu_mps, r->v_enu_mps, sizeof scene.v_enu_mps);
    memcpy(scene.reference_v_enu_mps, r->aim_v_enu_mps, sizeof scene.reference_v_enu_mps);
    return seeker_radar_measure(out, radar, &scene, stage->pool, stage->arena);
}

Status saved_radar_same(bool *same, const SavedFrame *file, const RadarFrame *radar)
{
    char         hash[sha256_text_size];
    const Status status = radar_sha256(hash, radar, 0, radar_arrays_most);
    *same = status == STATUS_OK && strcmp(hash, file->radar.map_sha256) == 0 &&
            radar->detections_in_all == file->radar.detections;
    return status;
}
