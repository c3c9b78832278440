/* sensor/radar/seeker_radar.h: the radar of a seeker: from a snapshot to what its receiver and processing make of
 * it.
 *
 * At the frame's time a coherent interval is centred. The beam is the sensor's boresight; the range window is about
 * the reference: the range to the aim, else to the ground along the boresight; of FMCW it begins at 0. Within beam and
 * window, and beyond it where echoes fold over (RadarPreset.far_m),
 *
 *     entities   by their scattering centres (centres.h), each with its own range rate from the motion of its part;
 *                as fewer echoes where the radar tells few of them apart (shot_targets.c)
 *     and the same by way of the ground near them, once and twice (ground_bounce.h)
 *     ground     by scatterers fixed to it (clutter.h), where relief and entities leave it in sight
 *     scenery    walls and roofs by their faces, and by way of the ground before walls (render/scattering/built);
 *                clutter by a few scatterers a thing of its shape's mean cross section
 *     plants     by scatterers in their crowns (foliage.h); what is behind or below is weakened, not hidden
 *     rain       by scatterers anew for each interval (volume_scatter.h)
 *     chaff      likewise; it weakens what is behind it
 *
 * go through the radar equation, the antenna's pattern at their own direction, and the air (radar_path.h) into the
 * samples of four channels; then receiver and processing. Phases are those of double ranges. A beam that scans
 * (radar_frame.h) has further intervals before and after.
 *
 * Left out: entities farther off the axis than u = 16 (two-way pattern below -80 dB) and ground beyond the main
 * lobe's null (RadarScene.reach); what one entity mirrors to another; range rates that change within the interval;
 * what FMCW's transmitter leaks into its receiver; the internal motion of ground within the interval (it moves
 * between intervals); diffraction about what hides part of an entity: each scattering centre is in sight or not. */
#ifndef SENSOR_RADAR_SEEKER_RADAR_H
#define SENSOR_RADAR_SEEKER_RADAR_H

#include "render/frame/world.h"
#include "render/scattering/signatures/signatures.h"
#include "render/scene/view.h"
#include "sensor/radar/radar_frame.h"

typedef struct SeekerRadarConfig {
    const char *preset;  /* a row of the table */
    const char *table;   /* path; NULL or empty: etc/radars.csv */
    const char *catalog; /* path; its models are built anew, as fine as the wavelength needs */
    const char *isa;
    bool        ground;        /* scatterers of the ground and of plants */
    bool        ground_bounce; /* the ground mirrors entities, and walls */
    bool        scenery;       /* echoes of buildings, works and clutter */
    double      scan_rad;      /* sector that the beam scans, about the boresight; 0: it stares */
    double      scan_step;     /* between its positions, over the beamwidth */
    double      warp_m;        /* unevenness of surfaces, rms (Warp of tubes.h) */
    const char *given;         /* a list of given signatures (given_signature.h); empty: none */
    double      wind_mps;
    double      chaff_dipoles; /* resonant ones in a cloud of chaff; 0: chaff is not seen */
    uint64_t    seed;
    const char *library;    /* folder of signatures, read and added to; NULL or empty: none */
    Cache      *cache;      /* where they are without a library; NULL: nowhere */
    bool        background; /* signatures that are missing are made in threads of their own; meanwhile an update is of
                             * coarse ones (coarse.h), all its targets alike, or is left out where these are missing too */
} SeekerRadarConfig;

typedef struct SeekerRadar SeekerRadar;

Status seeker_radar_create(SeekerRadar **out, const SeekerRadarConfig *config);
void   seeker_radar_destroy(SeekerRadar *radar); /* accepts NULL */

typedef struct RadarScene {
    const World    *world;
    const Snapshot *snapshot;
    const double   *joint;        /* values of the joints of its nodes, where these are posed; NULL: by snapshot_pose */
    const View     *view;         /* where the antenna is, and its axes */
    bool            refraction;   /* what relief hides is by rays that bend in air */
    int             hidden;       /* snapshot index of the host, -1: none; it is not in its own way */
    double          v_enu_mps[3]; /* of the antenna */
    double          reference_m;  /* range to the aim; NAN: to the ground ahead */
    double          reference_v_enu_mps[3]; /* of the aim; 0: of the ground */
    double          t_s;                    /* exercise time */
    const Weather  *weather;                /* at the ground */
    uint32_t        number;                 /* of the frame: for its noise */
    bool            coarse;                 /* with coarse signatures, as it was when it was recorded */
    double          reach;                  /* factor on the angles beyond which echoes are left out; 0: 1 */
    unsigned        skips_off;              /* 1 << Skip: no bit depends on it */
    bool            apart;                  /* each scattering centre is an echo of its own (slower, exact) */
    const float    *range_m; /* [view height][width]: of what each pixel shows, INFINITY: sky. NULL: no pixels */
    const uint32_t *entity;  /* likewise: snapshot index + 1, 0: none */
} RadarScene;

/* The configuration with which a radar makes signatures, during a run or beforehand. */
SignaturesConfig seeker_radar_signatures(const RadarPreset *preset, double warp_m, const char *isa);

/* *out in the arena. NULL: left out, as even coarse signatures are still being made in the background. */
Status seeker_radar_measure(const RadarFrame **out, SeekerRadar *radar, const RadarScene *scene, Pool *pool,
                            Arena *arena);

/* ---- before anything is in sight (radar_coarse.c) ------------------------------------------------------ */

/* Has the coarse signatures of a snapshot's entities made in the background, for all aspects. Without a background:
 * nothing. */
Status seeker_radar_prepare(SeekerRadar *radar, const Catalog *catalog, const Snapshot *snapshot);
/* Coarse signatures that were made, and that are still to be made. */
typedef struct RadarPrepared {
    int made, waiting;
} RadarPrepared;
RadarPrepared seeker_radar_prepared(const SeekerRadar *radar);

#endif
