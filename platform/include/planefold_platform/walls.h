/* Walls of a building plan, from a file, as the priors of planefold.h.
 *
 *   static pf_walls_t walls;
 *   char message[PF_WALLS_MESSAGE];
 *   if (pf_read_walls("plan.json", &walls, message) != 0) puts(message);
 *   for (int i = 0; i < walls.count; ++i) pf_add_wall(slam, &walls.wall[i].prior, &id[i]);
 *
 * Every function returns 0, or -1 with one line of plain text in message that names the file, the wall and the field, and
 * says what is wrong. Files are not trusted: whatever they hold, the answer is one of the two.
 */
#ifndef PLANEFOLD_PLATFORM_WALLS_H
#define PLANEFOLD_PLATFORM_WALLS_H

#include <planefold/planefold.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PF_WALLS_MESSAGE 1024 /* bytes of a message, with its terminating zero */
#define PF_WALLS_MAX 64       /* walls and faces of a file: the largest capacity.max_planes */
#define PF_WALLS_NAME 64      /* bytes of a name, with its terminating zero */

typedef struct pf_wall {
  char name[PF_WALLS_NAME]; /* no two are the same */
  pf_wall_prior_t prior;
} pf_wall_t;

typedef struct pf_walls {
  int32_t count;
  int32_t has_up; /* 1: the file says where up is; pf_set_gravity wants the opposite */
  double up_W[3]; /* unit length; (0, 0, 1) where the file does not say it */
  pf_wall_t wall[PF_WALLS_MAX];
} pf_walls_t;

/* JSON, lengths in metres, angles in degrees:
 *   {"planefold_walls": 1, "up": [0, 0, 1],
 *    "walls": [{"name", "from": [x, y], "to": [x, y], "base", "height", "seen_from": "left" | "right" | "both",
 *               "sigma_rotation_deg", "sigma_vertical_deg", "sigma_offset_m", "roughness_m"}],
 *    "faces": [{"name", "corners": [[x, y, z], ..], "seen_from": "front" | "both", and sigmas and roughness as of walls}]}
 * A wall stands upright on the line from .. to, from the height base on; left and right are as one walks from `from`. Walls need up to
 * be z. A face is any convex polygon; its corners go counter-clockwise where it is seen from its front.
 * sigma_rotation_deg is about the up direction, sigma_vertical_deg out of it, sigma_offset_m along the normal, all at the wall's own
 * centre. up, walls, faces, a face's seen_from (front) and roughness_m (that of the library's config) may be missing, and nothing else;
 * a field that is there twice or is not known is an error. */
int pf_read_walls(const char* path, pf_walls_t* walls, char message[PF_WALLS_MESSAGE]);

/* The same from text in memory; name stands for the file in messages. */
int pf_parse_walls(const char* text, size_t size, const char* name, pf_walls_t* walls, char message[PF_WALLS_MESSAGE]);

#ifdef __cplusplus
}
#endif

#endif
