/* entities/import/reader_private.h: what the readers of model files share: they run in a process of their own, see only
 * files of the model's folder, and hand back a flat scene and what there is to say. */
#ifndef ENTITIES_IMPORT_READER_PRIVATE_H
#define ENTITIES_IMPORT_READER_PRIVATE_H

#include "entities/import/model_import_private.h"
#include "pitviper_library.h"

/* The files of a model. `tank.obj.gz` is `tank.obj` to a reader; files that it names (materials, buffers) are in the
 * same folder. */
typedef struct ReaderFiles {
    const char *path;          /* path on disk */
    char        shown[1024];   /* without .gz */
    size_t      folder;        /* length of the folder's name with its slash */
    bool        no_memory;     /* there was no memory for a file of the model */
    char        refused[1100]; /* name of the first file that lies outside of the folder, or is not a file */
} ReaderFiles;

void reader_files(ReaderFiles *out, const char *path);
/* Reads all of a file, or of `name.gz`. name: with the folder, as in `shown`. *out is NUL-terminated. Nothing is
 * logged: STATUS_IO also where a file is refused. */
Status reader_read(char **out, size_t *octets, ReaderFiles *files, const char *name);

/* Lines for the user, which the process that asked for the model logs. */
typedef struct ReaderSaid {
    char error[600]; /* why there is no scene */
    int  warnings;
    char warning[8][300];
} ReaderSaid;

/* Returns `status`, so that a reader can end with it. */
__attribute__((format(printf, 3, 4))) Status reader_fails(ReaderSaid *said, Status status, const char *format, ...);
/* Adds a warning; those after the eighth are dropped. */
__attribute__((format(printf, 2, 3))) void reader_warns(ReaderSaid *said, const char *format, ...);

/* Fills a scene. When it fails, said->error says why, and *out may hold what was allocated. */
typedef Status Reader(ImportScene *out, ReaderSaid *said, ReaderFiles *files, const char *extension);

/* Runs `read` in a process with limits on time and memory, and checks its result as if a stranger had written it. Logs
 * one line on failure. */
Status reader_run(ImportScene *out, Reader *read, const char *path, const char *extension);

/* Allocates the scene's arrays, zeroed, by its counts. */
bool import_scene_room(ImportScene *scene);

/* The same from memory; other files are still of `files`. */
Status import_gltf_text(ImportScene *out, ReaderSaid *said, ReaderFiles *files, char *text, size_t octets);
/* Returns false when an index or a count is not possible in a whole scene. */
bool import_scene_is_sound(ImportScene *scene);

/* The text of an OBJ file in the forms that assimp reads: numbers without sign and exponent and with a digit before the
 * point, a statement a line, no texture coordinates (nothing uses them). *text is replaced. A statement that cannot be
 * meant as it is fails, with its line. lost: counts that it adds to. */
Status import_obj_plain(char **text, size_t *octets, int lost[IMPORT_LOST_COUNT], ReaderSaid *said, ReaderFiles *files);
/* The unit that 3MF, AMF and DXF name, in metres; 0: none. word: as it is said; empty: the format's default. */
double import_stated_unit(char word[24], const char *extension, const char *bytes, size_t octets);
/* The unit that comments of a text (OBJ, PLY, STL) name, in metres; 0: none. word: as it stands there. */
double import_comment_unit(char word[24], const char *text, size_t octets);

/* assimp, loaded when a model file is first imported. */

extern Library assimp_library;

#endif
