/* sensor/commands/rcs/rcs_private.h: what `pitviper rcs` makes: the fields of a target over aspect and frequency,
 * what is drawn of them, and libraries of signatures. */
#ifndef SENSOR_COMMANDS_RCS_RCS_PRIVATE_H
#define SENSOR_COMMANDS_RCS_RCS_PRIVATE_H

#include "render/scattering/signatures/given_signature.h"
#include "render/scattering/field/radar_model.h"
#include "render/scattering/field/total_field.h"

enum { rcs_most_frequencies = 64, rcs_most_looks = 36001, rcs_most_joints = 32 };

/* Where a joint stands. */
typedef struct RcsJoint {
    char   name[model_name_size]; /* of its node */
    double value;                 /* as given: deg, m */
} RcsJoint;

typedef struct RcsConfig {
    const char *name;
    double      from_deg, step_deg; /* azimuth, clockwise from the nose */
    int         looks;
    double      elevation_deg, range_m; /* INFINITY: plane waves */
    int         frequencies;
    double      frequency_hz[rcs_most_frequencies];
    double      rays_per_wavelength; /* 0: the default */
    int         splits;              /* of tubes at edges; -1: the default */
    double      warp_mm;             /* unevenness of surfaces, rms */
    bool        no_edges, no_polygons;
    int         joints; /* the others are at rest */
    RcsJoint    joint[rcs_most_joints];
    double      image_deg;    /* azimuth of the picture's middle; NaN: none */
    double      resolution_m; /* of the picture; 0: a sixtieth of the target, at least three wavelengths */
} RcsConfig;

typedef struct RcsSweep {
    RcsConfig       config;
    RadarMaterials  materials;
    RadarModel      model;
    GivenSignature *given; /* in place of the model; NULL: none */
    Pool           *pool;
    TubeConfig      tubes;
    TotalField      field;                    /* of the last look */
    ScatterMatrix  *s;                        /* [looks][frequencies] */
    long long       rays, hit_count, unknown; /* unknown: looks and frequencies that the given signature lacks */
    double          grid_db; /* error by another grid of tubes, of the power, some looks; NaN: none, or no difference */
} RcsSweep;

/* Logs what fails. A name given:FILE is a signature of given_signature.h, without a picture. */
Status      rcs_sweep_open(RcsSweep *out, const RcsConfig *config);
Status      rcs_sweep_run(RcsSweep *sweep);
void        rcs_sweep_close(RcsSweep *sweep); /* accepts zeroes */
const char *rcs_target_name(const RcsSweep *sweep);
double      rcs_look_deg(const RcsConfig *config, int look);

void rcs_write_csv(FILE *to, const RcsSweep *sweep);
/* Draws HH and VV of the first frequency over azimuth as a polar SVG. */
void rcs_plot(FILE *to, const RcsSweep *sweep);

/* An inverse synthetic aperture picture: range by frequency, cross range by azimuth, on the plane through the middle
 * of the target's height. */
typedef struct RcsImage {
    double middle_deg, span_deg, frequency_hz, bandwidth_hz, resolution_m, side_m; /* side_m: of the square shown */
    double centre[3];                                                              /* of the square, body axes */
    int    pulses, frequencies, pixels;
    float *hh_dbsm, *hv_dbsm; /* [pixels][pixels]: rows from the nose back, columns left to right */
} RcsImage;

Status rcs_image_make(RcsImage *out, RcsSweep *sweep);
Status rcs_image_write(const RcsImage *image, const RcsSweep *sweep, const char *path);
void   rcs_image_free(RcsImage *image);

/* `pitviper rcs MODEL --library FOLDER`: signatures for a seeker's radar, beforehand. */
extern const char rcs_library_help[];
/* Runs it with the argv of `rcs`; returns the exit code. */
int rcs_library_command(int argc, char **argv);

#endif
