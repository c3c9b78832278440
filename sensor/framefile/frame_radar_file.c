/* sensor/framefile/frame_radar_file.c: see frame_radar_file.h. */
#include "sensor/framefile/frame_radar_file.h"

#include "sensor/framefile/frame_fields.h"
#include "sensor/publish/plane_hash.h"
#include "sensor/publish/radar_record.h"
#include "sensor/world/frame_world.h"

void frame_fields_radar(Fields *f, FrameFile *file)
{
    FrameRadar *r = &file->radar;
    file->measured = true;
    field_reals(f, "velocity of a radar", r->v_enu_mps, 3, 1e6);
    field_bool(f, "aim of a radar", &r->has_aim);
    field_real(f, "range of a radar", &r->aim_m, 0, 1e9);
    field_reals(f, "velocity of a radar's aim", r->aim_v_enu_mps, 3, 1e6);
    field_u32(f, &r->number);
    field_chars(f, "map of a radar", r->map_sha256, sizeof r->map_sha256);
    field_int(f, "detections of a radar", &r->detections, 0, INT32_MAX - 1);
    if (!field_array(f, "joints", &r->joint_count, (void **)&r->joint, sizeof *r->joint, 8, INT32_MAX - 1)) return;
    for (int n = 0; n < r->joint_count && fields_good(f); n++) field_real(f, "a joint", &r->joint[n], -1e12, 1e12);
}

/* SHA-256 of the map; with a scan, of the map and both its images over range and azimuth. */
static Status hash_of(char out[sha256_text_size], const RadarFrame *r)
{
    const RadarScan *s = r->scan;
    if (!s) return radar_map_sha256(out, r);
    const int   rows = interval_channels * r->map.rows;
    const Plane plane[] = {{"range_doppler", PLANE_F64, 2 * r->map.columns, rows, r->map.cell},
                           {"scan", PLANE_F64, s->columns, s->plan.positions, s->power_w},
                           {"dbs", PLANE_F64, s->columns, s->azimuths, s->sharp_w}};
    return plane_hash(out, plane, 3);
}

Status frame_radar_gather(FrameFile *file, const RadarFrame *radar, double *joint)
{
    FrameRadar *r = &file->radar;
    file->measured = true;
    *r = (FrameRadar){.has_aim = !isnan(radar->aim_m), .aim_m = isnan(radar->aim_m) ? 0 : radar->aim_m, .number = radar->number,
                      .joint_count = file->snapshot.node_count, .joint = joint, .detections = radar->detections_in_all};
    memcpy(r->v_enu_mps, radar->v_enu_mps, sizeof r->v_enu_mps);
    memcpy(r->aim_v_enu_mps, radar->aim_v_enu_mps, sizeof r->aim_v_enu_mps);
    return hash_of(r->map_sha256, radar);
}

Status frame_radar_again(const RadarFrame **out, SeekerRadar *radar, const FrameFile *file, const Snapshot *snapshot,
                         const World *world, const Picture *picture, const Config *config, Pool *pool, Arena *arena)
{
    const FrameRadar *r = &file->radar;
    const Weather     weather = frame_weather_at(config, world, file->unix_s + file->time_s);
    RadarScene        scene = {.world = world, .snapshot = snapshot, .joint = r->joint, .view = &file->request.view,
                               .hidden = file->request.hidden_entity, .reference_m = r->has_aim ? r->aim_m : NAN,
                               .t_s = file->time_s, .weather = &weather, .number = r->number,
                               .range_m = picture->range_m, .entity = picture->entity};
    memcpy(scene.v_enu_mps, r->v_enu_mps, sizeof scene.v_enu_mps);
    memcpy(scene.reference_v_enu_mps, r->aim_v_enu_mps, sizeof scene.reference_v_enu_mps);
    return seeker_radar_measure(out, radar, &scene, pool, arena);
}

Status frame_radar_same(bool *same, const FrameFile *file, const RadarFrame *radar)
{
    char         hash[sha256_text_size];
    const Status status = hash_of(hash, radar);
    *same = status == STATUS_OK && strcmp(hash, file->radar.map_sha256) == 0 && radar->detections_in_all == file->radar.detections;
    return status;
}
