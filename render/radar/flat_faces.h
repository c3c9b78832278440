/* render/radar/flat_faces.h: the flat faces of a model: triangles of one part that touch and lie in one plane.
 *
 * Triangles that stand for a curved surface, by their vertex normals, are none. What is summed by faces and not by
 * triangles has its borders at real edges alone. */
#ifndef RENDER_RADAR_FLAT_FACES_H
#define RENDER_RADAR_FLAT_FACES_H

#include "entities/models/model.h"

typedef struct FlatFaces {
    int       count;
    int      *first;     /* [count + 1]: of each, in triangle */
    uint32_t *triangle;  /* of the model, by face and then by number */
    bool      convex;    /* one node of these faces alone, that no damage hides, and either a closed convex body or one
                          * face: a ray that leaves a face on the side it came from meets nothing */
} FlatFaces;

/* model: one that passes model_check. STATUS_NO_MEMORY is the only failure. */
Status flat_faces_find(FlatFaces *out, const Model *model);
void   flat_faces_free(FlatFaces *faces); /* frees and zeroes; accepts zeroes */

#endif
