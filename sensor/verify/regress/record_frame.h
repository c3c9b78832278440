/* sensor/verify/regress/record_frame.h: all recorded planes of one frame, from the folder of a run or from the EXR of
 * a baseline.
 *
 * A baseline is small because its numbers are rounded, below the tolerances of case_default; a run is rounded the same
 * way before it is compared, so that equal runs have zero difference. One step of each:
 *
 *     range_m            16 bits of mantissa      1.5e-5 relative at most
 *     nx, ny, nz         1/512                    0.002
 *     temp_k             1/32 K                   0.03 K
 *     optical            7 bits of mantissa       0.8 % at most
 *     mwir, lwir         10, 11 bits              0.03 K apparent at 300 K at most
 *     radar, profile     7 bits                   0.03 dB at most
 *     entity, part, material   as they are
 *
 * In the file a number is its count of steps, less that of its left neighbour, so that deflate finds small numbers
 * (half the size of rounded floats): see record_code_plane. 96 x 64 in all bands is some 45 kB a frame. */
#ifndef SENSOR_VERIFY_REGRESS_RECORD_FRAME_H
#define SENSOR_VERIFY_REGRESS_RECORD_FRAME_H

#include "pitviper.h"

typedef enum RecordPlane {
    FRAME_RANGE,
    FRAME_ENTITY,
    FRAME_PART,
    FRAME_MATERIAL,
    FRAME_TEMP,
    FRAME_NX,
    FRAME_NY,
    FRAME_NZ,
    FRAME_OPTICAL_R,
    FRAME_OPTICAL_G,
    FRAME_OPTICAL_B,
    FRAME_OPTICAL_Y,
    FRAME_MWIR,
    FRAME_LWIR,
    FRAME_RADAR,
    FRAME_PLANES
} RecordPlane;

enum { frame_bounces = 3, frame_size_max = 8192, frame_bins_max = 65536 };

typedef struct RecordFrame {
    int       number, width, height;
    float    *number_plane[FRAME_PLANES]; /* [height][width]; NULL: absent, or a plane of ids */
    uint32_t *id_plane[FRAME_PLANES];     /* entity, part, material */
    int       bins;                       /* 0: no profile */
    double    near_m, bin_m;              /* middle of the first bin; spacing */
    float    *profile[frame_bounces];     /* [bins] */
    char      date[32];                   /* of the exercise, as EXR writes it */
    char     *material_names;             /* comma-separated: the k-th is material k; NULL: an older baseline */
} RecordFrame;

const char *record_plane_name(RecordPlane plane); /* channel in the baseline */
bool        record_plane_is_id(RecordPlane plane);

/* Frame `number` of a replay, rounded. STATUS_IO, logged, when it is missing. */
Status record_frame_from_run(RecordFrame *out, const char *folder, int number);
/* The same of record/. like: only a frame of that size and number of bins is read; else STATUS_BAD_VALUE, logged. */
Status record_frame_from_record(RecordFrame *out, const char *folder, const RecordFrame *like);
/* Of record/: sizes in the headers of its files, without reading planes. bins 0: no profile. */
typedef struct RecordFrameSize {
    int width, height, bins;
} RecordFrameSize;
Status record_frame_size(RecordFrameSize *out, const char *folder, int number);
/* Renames the materials of `frame` as `like` numbers them, by name; a name that only `frame` has gets a number beyond
 * those of `like`. Nothing changes where one of them has no names. STATUS_NO_MEMORY. */
Status record_frame_rename_materials(RecordFrame *frame, const RecordFrame *like);
Status record_frame_write(const char *folder, const RecordFrame *frame);
void   record_frame_free(RecordFrame *frame);

/* Rounding in whole steps: to that many bits of mantissa (1 .. 22), or to the nearest multiple of a step. Infinity and
 * NaN have reserved numbers; -0 is 0. record_value is the inverse. */
typedef struct Rounding {
    int    bits; /* 0: by step */
    double step;
} Rounding;
int32_t record_steps(const Rounding *rounding, float value);
float   record_value(const Rounding *rounding, int32_t steps);
/* Differences to the left neighbour, as stored in the file; and the inverse. Must not alias. */
void record_code_plane(uint32_t *coded, const float *value, int width, int height, const Rounding *rounding);
void record_decode_plane(float *value, const uint32_t *coded, int width, int height, const Rounding *rounding);

#endif
