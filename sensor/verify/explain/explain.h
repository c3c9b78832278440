/* sensor/verify/explain/explain.h: one pixel of a saved frame, explained: its rays, what they met, the terms of its
 * light, and its way through the detector; `pitviper explain`.
 *
 * The frame is rendered again from its file, whole, with a record of that pixel (render/frame/pixel_record.h). Terms
 * come from the functions that shade; their sum in the order of the program must be the plane's value to the bit. */
#ifndef SENSOR_VERIFY_EXPLAIN_EXPLAIN_H
#define SENSOR_VERIFY_EXPLAIN_EXPLAIN_H

#include "render/frame/pixel_record.h"
#include "sensor/frame/frame_display.h"
#include "sensor/verify/saved_frame/saved_again.h"
#include "sensor/verify/saved_frame/saved_scene.h"

/* What a plane's value is the sum of, at the eye. */
typedef enum ExplainTerm {
    EXPLAIN_EMITTED,
    EXPLAIN_SUN,          /* reflected, or let through by leaves */
    EXPLAIN_SKY,          /* likewise */
    EXPLAIN_GROUND,       /* light of the ground on the surface, likewise */
    EXPLAIN_SURROUNDINGS, /* of plants about it; with sensor.sky_samples of all that is about it */
    EXPLAIN_LAMPS,        /* their own, and reflected */
    EXPLAIN_PATH,         /* radiance of the air before it, of a ray to the sky: the sky */
    EXPLAIN_BEYOND,       /* ground beyond the terrain's edge */
    EXPLAIN_DISC,         /* the sun itself */
    EXPLAIN_SMOKE,        /* radiance of smoke, dust and flames before it */
    EXPLAIN_NEIGHBOURS,   /* of plants: what the neighbouring pixels give (leaf_filter.c) */
    EXPLAIN_BOUNCES,      /* the pseudo-radar's first; two more follow */
    EXPLAIN_TERMS = EXPLAIN_BOUNCES + radar_bounces
} ExplainTerm;
extern const char *const explain_term_name[EXPLAIN_TERMS];

/* A radiance plane at the pixel. */
typedef struct ExplainedPlane {
    char               name[frame_plane_name_size]; /* `lwir/Y` */
    const char        *unit;
    int                plane; /* of the picture */
    Band               band;
    bool               is_radar;
    AirBand            channel; /* of the light; not the radar's */
    const PixelRecord *record;  /* and the plane of its picture: */
    int                recorded_plane;
    float              value, sum; /* of the plane; of the terms, in the order of the program: the same bits */
    double             term[EXPLAIN_TERMS];
    double             passes[3]; /* mean transmittance, by weight: of the path for what is emitted and for light of the
                                     air; of smoke. NaN: no surface */
    double  temp_k;               /* apparent temperature; NaN: not thermal */
    double *weight;               /* [record->samples]: of each sample in the value */
} ExplainedPlane;

/* A band behind its detector at the pixel. */
typedef struct ExplainedBand {
    bool          there, has_chain, curved;
    int           channels, grey[3]; /* displayed, 8 bits */
    float         displayed[3];      /* before its level: counts or radiance, R G B balanced */
    DetectorLevel level;             /* black and white */
    ChainWatch    watch;
} ExplainedBand;

typedef struct Explained {
    int               x, y;
    const SavedFrame *file;
    const SavedScene *scene;
    const Picture    *picture;
    int               differ; /* planes that are not those of the file */
    PixelRecord       record[pixel_records];
    int               planes, wrong; /* wrong: whose sum is not its value */
    ExplainedPlane    plane[picture_plane_count];
    ExplainedBand     band[BAND_COUNT];
} Explained;

/* Renders the frame of a file, which the scene is of, and explains a pixel; x, y within its picture. Arena: of all that
 * is in it. A sum that is not its plane's value, and planes that are not the file's, are logged and counted.
 * explain_close must follow, also on failure. */
Status explain_pixel(Explained *out, SavedFrame *file, SavedScene *scene, int x, int y, Pool *pool, Arena *arena);
void   explain_close(Explained *explained);

/* In words, some 40 lines; and as JSON, with every sample. */
void   explain_print(FILE *to, const Explained *explained);
Status explain_print_json(FILE *to, const Explained *explained);

/* Names of what a sample met: `1:3001:11 truck, hull`, `ground, grass`, `oak`, `sky`. */
void explain_surface(char *out, size_t size, const Explained *e, const PixelSample *sample);

#endif
