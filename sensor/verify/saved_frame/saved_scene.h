/* sensor/verify/saved_frame/saved_scene.h: everything that a frame file needs from this installation, opened and
 * compared with that of the original frame: settings, tables, models, sensors; and its own ground. */
#ifndef SENSOR_VERIFY_SAVED_FRAME_SAVED_SCENE_H
#define SENSOR_VERIFY_SAVED_FRAME_SAVED_SCENE_H

#include "sensor/verify/saved_frame/saved_frame.h"
#include "sensor/settings/sensors.h"
#include "sensor/settings/config.h"
#include "sensor/settings/tables_used.h"

typedef struct SavedScene {
    Config       config;
    Cache       *cache; /* of the disk; NULL: none */
    Sensors      sensors;
    Catalog     *catalog;
    Landscape    landscape;
    FrameScenery scenery;
    Woods        woods; /* of the world's plants, if any */
    World        world;
    EffectTable  effects;
    Snapshot     snapshot; /* the file's, with the models of this catalog */
    int          tables_differ;
} SavedScene;

/* Tables and models that differ from those of the frame are logged by name: STATUS_BAD_VALUE unless forced.
 * saved_scene_close must follow, also on failure. isa: as world_open. */
Status saved_scene_open(SavedScene *out, const SavedFrame *file, bool forced, const char *isa, Pool *pool);
void   saved_scene_close(SavedScene *scene);

/* ---- the ground: in the file, or the terrain store that it names --------------------------------- */

/* Parts may be of a hostile file. Failures are logged. */
Status saved_ground_open(Landscape *out, const LandscapeParts *parts);
/* What stands on it, made of a file's records and the ground; nothing for a file without. The culture is laid on the
 * landscape. frame_scenery_free after success and failure. forced: what is not that of the frame is a warning. */
Status saved_scenery_make(FrameScenery *out, Landscape *landscape, const SavedFrame *file, bool forced);
/* The plants on it, into a world over that ground; nothing for a file without. They are taken from the world's cache
 * where that has them; follows: what the landscape and the tables follow from, NULL: not known. culture: of the file.
 * woods must outlive the world, and is destroyed by the caller, also on failure. */
Status saved_ground_plant(World *world, Woods *woods, const SavedFrame *file, const Culture *culture,
                          const Config *config, const char *follows, const char *isa, Pool *pool);
/* What its landscape and tables follow from, for saved_ground_plant. False: there is no memory. */
enum { saved_follows_size = 2 * sha256_text_size };
bool saved_follows(char out[saved_follows_size], const SavedFrame *file, const TablesUsed *tables);

/* ---- tables -------------------------------------------------------------------------------------- */

/* Lists the tables that a frame depends on: those of tables_used, and the user's own, where models.catalog and
 * models.materials have these names. catalog: that of etc/. */
Status saved_tables(TablesUsed *out, const Config *config, const char *catalog);

#endif
