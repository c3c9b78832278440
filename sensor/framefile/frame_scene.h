/* sensor/framefile/frame_scene.h: everything that a frame file needs from this installation, opened and compared
 * with that of the original frame: settings, tables, models, sensors; and its own ground. */
#ifndef SENSOR_FRAMEFILE_FRAME_SCENE_H
#define SENSOR_FRAMEFILE_FRAME_SCENE_H

#include "sensor/framefile/frame_file.h"
#include "sensor/settings/sensors.h"

typedef struct FrameScene {
    Config      config;
    Sensors     sensors;
    Catalog    *catalog;
    Landscape   landscape;
    Woods       woods;         /* of the world's plants, if any */
    World       world;
    EffectTable effects;
    Snapshot    snapshot;      /* the file's, with the models of this catalog */
    int         tables_differ;
} FrameScene;

/* Tables and models that differ from those of the frame are logged by name: STATUS_BAD_VALUE unless forced.
 * frame_scene_close must follow, also on failure. isa: as world_open. */
Status frame_scene_open(FrameScene *out, const FrameFile *file, bool forced, const char *isa, Pool *pool);
void   frame_scene_close(FrameScene *scene);

#endif
