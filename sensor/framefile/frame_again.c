/* sensor/framefile/frame_again.c: renders the picture of a frame file again, hashes it plane by plane and compares. */
#include "sensor/framefile/frame_again.h"

#include "sensor/world/frame_light.h"

/* ---- results ------------------------------------------------------------------------------ */

/* Of a complex plane the magnitude. */
static double value_at(const Plane *plane, size_t i)
{
    const float *part = plane->values;
    switch (plane->type) {
    case PLANE_C64: return hypot((double)part[2 * i], (double)part[2 * i + 1]);
    case PLANE_F32: return (double)((const float *)plane->values)[i];
    case PLANE_U32: return ((const uint32_t *)plane->values)[i];
    case PLANE_U8: return ((const uint8_t *)plane->values)[i];
    case PLANE_F64: break;
    }
    return ((const double *)plane->values)[i];
}

static void measure(FramePlane *out, const Plane *plane)
{
    const size_t count = (size_t)plane->width * (size_t)plane->height;
    double       sum = 0;
    out->finite = 0;
    out->low    = INFINITY;
    out->high   = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double value = value_at(plane, i);
        if (!isfinite(value)) continue;
        out->finite++;
        sum += value;
        out->low  = fmin(out->low, value);
        out->high = fmax(out->high, value);
    }
    out->mean = out->finite > 0 ? sum / out->finite : 0;
}

Status frame_made(FrameMade *out, const FrameArray *from, int count)
{
    Plane plane[frame_max_planes] = {0};
    *out = (FrameMade){.plane_count = count};
    for (int i = 0; i < count; i++) plane[i] = frame_plane(out->plane[i].name, &from[i]);
    Status status = plane_hash(out->sha256, plane, count);
    for (int i = 0; i < count && status == STATUS_OK; i++) {
        FramePlane *p = &out->plane[i];
        measure(p, &plane[i]);
        status = plane_hash(p->sha256, &plane[i], 1);
    }
    return status;
}

/* ---- rendered again --------------------------------------------------------------------------------- */

Status frame_again(FrameAgain *out, const FrameFile *file, const Snapshot *snapshot, const World *world,
                   const Config *config, bool no_skip, Pool *pool, Arena *arena)
{
    RenderRequest  request = file->request;
    const double  *p_ecef = file->eye.p_ecef;
    const FrameEye at = {file->unix_s + file->time_s, {p_ecef[0], p_ecef[1], p_ecef[2]}, &request.view, request.bands, &snapshot->marks};
    Air            air;
    double         r_host_from_enu[9];
    request.skips_off = no_skip ? skips_all_off : 0;
    Status status     = frame_light(&air, &out->sun, r_host_from_enu, world, config, &at, pool, arena);
    if (status == STATUS_OK) status = render(&out->picture, world, snapshot, &request, &air, pool, arena);
    if (status != STATUS_OK) return status;
    if (out->picture.normal[0]) turn_normals(&out->picture, r_host_from_enu);
    FrameArray plane[frame_max_planes];
    return frame_made(&out->made, plane, frame_planes(plane, &out->picture, &request));
}

/* ---- compared ----------------------------------------------------------------------------------- */

static const FramePlane *plane_named(const FramePlane *plane, int count, const char *name)
{
    for (int i = 0; i < count; i++)
        if (strcmp(plane[i].name, name) == 0) return &plane[i];
    return NULL;
}

int frame_differences(const FrameFile *file, const FrameMade *made, bool said)
{
    int different = 0;
    for (int i = 0; i < file->plane_count; i++) {
        const FramePlane *was = &file->plane[i], *is = plane_named(made->plane, made->plane_count, was->name);
        if (is && strcmp(is->sha256, was->sha256) == 0) continue;
        different++;
        if (!said) continue;
        if (!is) {
            log_error("frame: %s is not among the planes that this request gives here", was->name);
            continue;
        }
        log_error("frame: %s differs: mean %.9g, was %.9g; from %.9g to %.9g, was %.9g to %.9g; %.0f finite values, "
                  "were %.0f", was->name, is->mean, was->mean, is->low, is->high, was->low, was->high, is->finite,
                  was->finite);
    }
    for (int i = 0; i < made->plane_count; i++) {
        if (plane_named(file->plane, file->plane_count, made->plane[i].name)) continue;
        different++;
        if (said) log_error("frame: %s is not in the file", made->plane[i].name);
    }
    return different + (different == 0 && strcmp(made->sha256, file->frame_sha256) != 0);
}
