/* sensor/radar/radar_chaff.c: clouds of chaff: what they take from every echo behind them, and their own echoes. */
#include "sensor/radar/radar_volume.h"

#include "render/radar/chaff.h"

enum { points_a_task = 512, points_most = 16384, stream_chaff = 0x43484600 };

struct ChaffCloud {
    double   p_enu[3], v_enu_mps[3], radius_m, dipoles;
    uint32_t id;
};

Status making_chaff_open(Making *m)
{
    const Snapshot    *snapshot = m->scene->snapshot;
    const LocalFrame  *frame = &m->scene->world->frame;
    struct ChaffCloud *cloud;
    if (snapshot->chaff_count == 0 || !(m->radar->chaff_dipoles > 0)) return STATUS_OK;
    cloud = arena_alloc(m->arena, (size_t)snapshot->chaff_count, sizeof *cloud);
    if (!cloud) return STATUS_NO_MEMORY;
    for (int i = 0; i < snapshot->chaff_count; i++) {
        const SnapshotChaff *from = &snapshot->chaff[i];
        enu_from_ecef(cloud[i].p_enu, frame, from->p_ecef);
        m3_tmul_v3(cloud[i].v_enu_mps, frame->r_ecef_from_enu, from->v_ecef_mps);
        cloud[i].radius_m = chaff_radius_m(from->age_s);
        cloud[i].dipoles = m->radar->chaff_dipoles;
        cloud[i].id = (uint32_t)from->id.site << 16 ^ (uint32_t)from->id.application << 8 ^ from->id.entity;
        if (v3_length(cloud[i].v_enu_mps) > 0) continue;
        /* reported at rest: where it was dispensed, and left to the air since */
        making_wind(cloud[i].v_enu_mps, m);
        cloud[i].v_enu_mps[2] -= chaff_fall_mps;
        v3_add_scaled(cloud[i].p_enu, cloud[i].p_enu, from->age_s, cloud[i].v_enu_mps);
    }
    m->chaff = cloud;
    m->chaff_count = snapshot->chaff_count;
    return STATUS_OK;
}

double making_chaff_np(const Making *m, const Sight *sight)
{
    const double wavelength_m = m->preset->antenna.wavelength_m;
    double       column = 0;
    for (int i = 0; i < m->chaff_count; i++) {
        double centre[3];
        v3_sub(centre, m->chaff[i].p_enu, m->p_enu);
        column += chaff_column_1_m2(m->chaff[i].dipoles, m->chaff[i].radius_m, centre, sight->d_enu, sight->range_m);
    }
    return column * chaff_taken * wavelength_m * wavelength_m;
}

typedef struct ChaffJob {
    const struct ChaffCloud *cloud;
    int                      points;
    uint32_t                 key;
} ChaffJob;

static int make_chaff(RadarPoint *out, const Making *m, void *user, int task)
{
    static _Thread_local VolumePoint point[points_a_task];
    const ChaffJob          *job = user;
    const struct ChaffCloud *cloud = job->cloud;
    const uint64_t           seed = m->radar->seed;
    const double             wavelength_m = m->preset->antenna.wavelength_m;
    const double             sigma_m2 = chaff_same * wavelength_m * wavelength_m * cloud->dipoles / job->points;
    int                      count = 0;
    for (int i = task * points_a_task; i < (task + 1) * points_a_task && i < job->points; i++) {
        VolumePoint *to = &point[count];
        double       n[13], p[3];
        random_normals(n, 13, seed, stream_chaff, job->key ^ cloud->id, 13 * (uint64_t)i);
        v3_add_scaled(p, cloud->p_enu, cloud->radius_m, n);
        making_sight(&to->sight, m, p, 0);
        if (!to->sight.within || making_off_axis(m, &to->sight) > m->widest) continue;
        chaff_scatter(&to->s, sigma_m2, n + 3);
        to->turns = false;
        v3_add_scaled(to->v_enu_mps, cloud->v_enu_mps, chaff_turbulence_mps, n + 9);
        to->v_enu_mps[2] += chaff_fall_spread_mps * n[12];
        count++;
    }
    return count > 0 ? making_keep(out, point, count, m, 0, m->widest) : 0;
}

Status making_chaff(Making *m)
{
    const double cell_m = 0.5 * light_mps / m->preset->wave.bandwidth_hz;
    Status       status = STATUS_OK;
    for (int i = 0; i < m->chaff_count && status == STATUS_OK; i++) {
        const struct ChaffCloud *cloud = &m->chaff[i];
        Sight                    sight;
        making_sight(&sight, m, cloud->p_enu, 5 * cloud->radius_m);
        const double room = 5 * cloud->radius_m / fmax(sight.range_m, 1);
        if (!sight.within || making_off_axis(m, &sight) > m->widest + room) continue;
        /* some 32 points in a step of range, the cloud being six radii long */
        ChaffJob job = {cloud, (int)clamp(ceil(32 * 6 * cloud->radius_m / cell_m), 512, points_most), making_key(m)};
        status = making_points(m, (job.points + points_a_task - 1) / points_a_task, points_a_task, make_chaff, &job);
        m->frame->clouds++;
    }
    return status;
}
