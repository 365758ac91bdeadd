/* Names of kinds and of their fields as constants: a misspelt one does not compile, and editors complete them.
 *
 *     skein_body_add(world, SKEIN_CLOTH, NULL, SKEIN_SETTINGS(SKEIN_PAIR(SKEIN_CLOTH_GRID, 33, 33)), NULL);
 *     skein_set(world, cloth, SKEIN_CLOTH_STRETCH_STIFFNESS, skein_number(2e4));
 *
 * A kind's own fields begin with its name, those that a whole category has with the category's (SKEIN_BODY_VISIBLE).
 * Made by `make names` from the library's own tables: do not edit it by hand. Defaults and ranges are in
 * docs/reference.md. Each constant is a plain text, and texts do as well. */
#ifndef SKEIN_NAMES_H
#define SKEIN_NAMES_H

#include <skein/skein.h>

/* A number that the formulas of an object name: SKEIN_PARAMETER("L"). */
#define SKEIN_PARAMETER(name_) "parameters." name_

// clang-format off

/* ---- bodies ---- */

/* of every body */
#define SKEIN_BODY_NAME "name" /* a text; for paths, messages and the names of files */
#define SKEIN_BODY_ENABLED "enabled" /* true or false; false: as if it were not there; it stays as it is until it is again */
#define SKEIN_BODY_VISIBLE "visible" /* true or false; whether it is drawn */
#define SKEIN_BODY_GROUPS "groups" /* a text; the names of groups that it is in, commas between them: where rules name bodies, a group's name means all in it */
#define SKEIN_BODY_SLEEP "sleep" /* a number in m/s; it falls asleep once it, and all that it may touch, has for half a second not gone farther than that speed would lead: it then costs nothing, until something comes near or is changed; 0: never */

#define SKEIN_CLOTH "cloth" /* a sheet from a triangle or quad mesh, or a grid: springs along and across, bending by angle, tethers to pins */
#define SKEIN_CLOTH_MESH "mesh" /* a text; file of a mesh, OBJ, OFF, PLY, STL or glTF (in scenes; a program passes the mesh itself) */
#define SKEIN_CLOTH_GRID "grid" /* two whole numbers; instead of a mesh: rows and columns of particles */
#define SKEIN_CLOTH_SIZE "size" /* two numbers in m; of a grid, along x and z before it is turned */
#define SKEIN_CLOTH_POSITION "position" /* three numbers in m; where the mesh's origin (a grid's middle) is put */
#define SKEIN_CLOTH_ROTATION "rotation" /* three numbers in deg; turned about x, then y, then z, before it is put there */
#define SKEIN_CLOTH_SCALE "scale" /* a number; factor on the mesh's coordinates */
#define SKEIN_CLOTH_VELOCITY "velocity" /* three numbers in m/s; at the start */
#define SKEIN_CLOTH_FABRIC "fabric" /* a word; a real one's density, stretch, shear, bend.rigidity and contact, where they are not given themselves */
#define SKEIN_CLOTH_FABRIC_NONE "none"
#define SKEIN_CLOTH_FABRIC_COTTON "cotton"
#define SKEIN_CLOTH_FABRIC_SILK "silk"
#define SKEIN_CLOTH_FABRIC_DENIM "denim"
#define SKEIN_CLOTH_FABRIC_WOOL "wool"
#define SKEIN_CLOTH_FABRIC_FELT "felt"
#define SKEIN_CLOTH_FABRIC_RUBBER "rubber"
#define SKEIN_CLOTH_FABRIC_PAPER "paper"
#define SKEIN_CLOTH_DENSITY "density" /* a number in kg/m2; mass of a square metre, shared out to the corners */
#define SKEIN_CLOTH_WELD "weld" /* a number in m; vertices nearer than this become one particle; 0 joins none */
#define SKEIN_CLOTH_PINS "pins" /* a text; pinned particles: "corners", "top corners", "top edge", numbers, "box x y z x y z", "sphere x y z r" */
#define SKEIN_CLOTH_STRETCH_STIFFNESS "stretch.stiffness" /* a number in N/m; of the sheet along its threads (1e4 is a firm cotton) */
#define SKEIN_CLOTH_STRETCH_DAMPING "stretch.damping" /* a number in N s/m; of stretching; other motion is free */
#define SKEIN_CLOTH_SHEAR_STIFFNESS "shear.stiffness" /* a number in N/m; across the threads */
#define SKEIN_CLOTH_SHEAR_DAMPING "shear.damping" /* a number in N s/m; of shearing */
#define SKEIN_CLOTH_SHEAR_DIAGONALS "shear.diagonals" /* a word; springs; or ties, slack when shorter, so that folds can run to one point; "pins": ties where all pins are within three edges and an eighth of the sheet, else springs */
#define SKEIN_CLOTH_SHEAR_DIAGONALS_SPRINGS "springs"
#define SKEIN_CLOTH_SHEAR_DIAGONALS_TIES "ties"
#define SKEIN_CLOTH_SHEAR_DIAGONALS_PINS "pins"
#define SKEIN_CLOTH_BEND_BY "bend.by" /* a word; `dihedral` angles at edges, `isometric` curvature there, or `straight` lines and `twist` of a flat grid, which take the rigidity; "shape": lines of a flat grid, curvature of what else is flat, else angles; or springs over folds */
#define SKEIN_CLOTH_BEND_BY_SPRINGS "springs"
#define SKEIN_CLOTH_BEND_BY_ANGLE "angle"
#define SKEIN_CLOTH_BEND_BY_CURVATURE "curvature"
#define SKEIN_CLOTH_BEND_BY_LINES "lines"
#define SKEIN_CLOTH_BEND_BY_SHAPE "shape"
#define SKEIN_CLOTH_BEND_STIFFNESS "bend.stiffness" /* a number in N/m; of the springs over folds */
#define SKEIN_CLOTH_BEND_DAMPING "bend.damping" /* a number in N s/m; of the springs over folds */
#define SKEIN_CLOTH_BEND_RIGIDITY "bend.rigidity" /* a number in N m; of the sheet against angle or curvature, the same at any resolution (1e-5 is a cotton) */
#define SKEIN_CLOTH_STRETCH_LIMIT "stretch.limit" /* a number; strain limit: no edge gets longer than rest times 1 + this; "infinite" is none */
#define SKEIN_CLOTH_STRETCH_TETHER "stretch.tether" /* a number; no particle gets farther from a pin, or from any 5 or 20 edges away, than along the cloth, times 1 + this; "infinite" is none */
#define SKEIN_CLOTH_STRETCH_TEAR "stretch.tear" /* a number; stretch at which an edge gives way, with the faces beside it, when a step is over; 0: never */
#define SKEIN_CLOTH_CONTACT_THICKNESS "contact.thickness" /* a number in m; its own, in contact: two surfaces come as near as the mean of theirs; 0: what the force `contact` says */
#define SKEIN_CLOTH_CONTACT_FRICTION "contact.friction" /* a number; with a contact.thickness: its coefficient of friction in contact; of two surfaces the mean counts */
#define SKEIN_CLOTH_LOOK "look" /* a word; what its surface is drawn as: woven; smooth and lit through, with round edges; or of one colour */
#define SKEIN_CLOTH_LOOK_CLOTH "cloth"
#define SKEIN_CLOTH_LOOK_JELLY "jelly"
#define SKEIN_CLOTH_LOOK_PLAIN "plain"

#define SKEIN_LATTICE "lattice" /* a block of particles with springs to its neighbours: along the axes, across, two apart, face to face */
#define SKEIN_LATTICE_GRID "grid" /* three whole numbers; particles along x, y and z; the last runs fastest */
#define SKEIN_LATTICE_SIZE "size" /* three numbers in m; along x, y and z before it is turned */
#define SKEIN_LATTICE_POSITION "position" /* three numbers in m; where its middle is put */
#define SKEIN_LATTICE_ROTATION "rotation" /* three numbers in deg; turned about x, then y, then z, before it is put there */
#define SKEIN_LATTICE_VELOCITY "velocity" /* three numbers in m/s; at the start */
#define SKEIN_LATTICE_MASS "mass" /* a number in kg; of all of it, shared out equally to the particles */
#define SKEIN_LATTICE_DENSITY "density" /* a number in kg/m3; instead of the mass, where it is over 0 */
#define SKEIN_LATTICE_PINS "pins" /* a text; pinned particles: "left face" (right, bottom, top, back, front), "corners", numbers, "box x y z x y z", "sphere x y z r" */
#define SKEIN_LATTICE_STRUCTURAL_STIFFNESS "structural.stiffness" /* a number in N/m; of each spring along the axes */
#define SKEIN_LATTICE_STRUCTURAL_DAMPING "structural.damping" /* a number in N s/m; of each */
#define SKEIN_LATTICE_STRUCTURAL_LIMIT "structural.limit" /* a number; strain limit: none gets longer than rest times 1 + this; "infinite" is none */
#define SKEIN_LATTICE_SHEAR_STIFFNESS "shear.stiffness" /* a number in N/m; of each diagonal */
#define SKEIN_LATTICE_SHEAR_DAMPING "shear.damping" /* a number in N s/m; of each */
#define SKEIN_LATTICE_SHEAR_DIAGONALS "shear.diagonals" /* a word; which there are: across faces, across the body of a cell, both or none */
#define SKEIN_LATTICE_SHEAR_DIAGONALS_ALL "all"
#define SKEIN_LATTICE_SHEAR_DIAGONALS_FACES "faces"
#define SKEIN_LATTICE_SHEAR_DIAGONALS_BODY "body"
#define SKEIN_LATTICE_SHEAR_DIAGONALS_NONE "none"
#define SKEIN_LATTICE_BENDING_STIFFNESS "bending.stiffness" /* a number in N/m; of each spring between particles 2 apart, and of each strut */
#define SKEIN_LATTICE_BENDING_DAMPING "bending.damping" /* a number in N s/m; of each */
#define SKEIN_LATTICE_BENDING_SPRINGS "bending.springs" /* true or false; whether there are springs between particles 2 apart */
#define SKEIN_LATTICE_STRUTS "struts" /* true or false; whether there are struts from face to face, a line each */
#define SKEIN_LATTICE_LOOK "look" /* a word; what its surface is drawn as: woven; smooth and lit through, with round edges; or of one colour */
#define SKEIN_LATTICE_LOOK_CLOTH "cloth"
#define SKEIN_LATTICE_LOOK_JELLY "jelly"
#define SKEIN_LATTICE_LOOK_PLAIN "plain"

#define SKEIN_ROPE "rope" /* a line of particles, straight or hanging between its ends */
#define SKEIN_ROPE_COUNT "count" /* a whole number; particles from end to end */
#define SKEIN_ROPE_FROM "from" /* three numbers in m; its first particle */
#define SKEIN_ROPE_TO "to" /* three numbers in m; its last particle, or the way to go there */
#define SKEIN_ROPE_LENGTH "length" /* a number in m; 0: from one end to the other; a longer one hangs between them, a shorter one ends before */
#define SKEIN_ROPE_VELOCITY "velocity" /* three numbers in m/s; at the start */
#define SKEIN_ROPE_DENSITY "density" /* a number in kg/m; mass of a metre, shared out equally */
#define SKEIN_ROPE_PINS "pins" /* a text; pinned particles: "first", "last", numbers, "box x y z x y z", "sphere x y z r" */
#define SKEIN_ROPE_STRETCH_STIFFNESS "stretch.stiffness" /* a number in N; the force that would make it twice as long */
#define SKEIN_ROPE_STRETCH_DAMPING "stretch.damping" /* a number in N s; of stretching */
#define SKEIN_ROPE_BEND_STIFFNESS "bend.stiffness" /* a number in N; the same of springs between particles 2 apart; 0 is a chain */
#define SKEIN_ROPE_BEND_DAMPING "bend.damping" /* a number in N s; of bending */
#define SKEIN_ROPE_STRETCH_LIMIT "stretch.limit" /* a number; strain limit: no part gets longer than rest times 1 + this; "infinite" is none */
#define SKEIN_ROPE_STRETCH_TETHER "stretch.tether" /* a number; no particle gets farther from a pin than along the rope, times 1 + this; "infinite" is none */

#define SKEIN_TETRAHEDRA "tetrahedra" /* a soft body from a mesh of tetrahedra: springs along the edges, and volumes that are kept */
#define SKEIN_TETRAHEDRA_MESH "mesh" /* a text; file of a mesh, .node with .ele beside it (in scenes; a program passes the mesh itself) */
#define SKEIN_TETRAHEDRA_POSITION "position" /* three numbers in m; where the mesh's origin is put */
#define SKEIN_TETRAHEDRA_ROTATION "rotation" /* three numbers in deg; turned about x, then y, then z, before it is put there */
#define SKEIN_TETRAHEDRA_SCALE "scale" /* a number; factor on the mesh's coordinates */
#define SKEIN_TETRAHEDRA_VELOCITY "velocity" /* three numbers in m/s; at the start */
#define SKEIN_TETRAHEDRA_DENSITY "density" /* a number in kg/m3; mass of a cubic metre, shared out to the corners */
#define SKEIN_TETRAHEDRA_PINS "pins" /* a text; pinned particles: "all", numbers, "box x y z x y z", "sphere x y z r" */
#define SKEIN_TETRAHEDRA_STIFFNESS "stiffness" /* a number in Pa; Young's modulus of the springs along the edges (1e4 is a jelly, 1e6 a rubber) */
#define SKEIN_TETRAHEDRA_DAMPING "damping" /* a number in Pa s; of the same */
#define SKEIN_TETRAHEDRA_VOLUME_STIFFNESS "volume.stiffness" /* a number in Pa; bulk modulus: against a change of each tetrahedron's volume, besides the springs' own */
#define SKEIN_TETRAHEDRA_VOLUME_DAMPING "volume.damping" /* a number in Pa s; of the same */
#define SKEIN_TETRAHEDRA_LIMIT "limit" /* a number; strain limit: no edge gets longer than rest times 1 + this; "infinite" is none */
#define SKEIN_TETRAHEDRA_LOOK "look" /* a word; what its surface is drawn as: woven; smooth and lit through, with round edges; or of one colour */
#define SKEIN_TETRAHEDRA_LOOK_CLOTH "cloth"
#define SKEIN_TETRAHEDRA_LOOK_JELLY "jelly"
#define SKEIN_TETRAHEDRA_LOOK_PLAIN "plain"

#define SKEIN_FLOCK "flock" /* loose particles, each flying its own way, for rules that steer */
#define SKEIN_FLOCK_COUNT "count" /* a whole number; of particles */
#define SKEIN_FLOCK_SIDE "side" /* a whole number; side x side particles instead of count; 0: count */
#define SKEIN_FLOCK_POSITION "position" /* three numbers in m; the middle */
#define SKEIN_FLOCK_SPREAD "spread" /* three numbers in m; size of the box that they are strewn in, evenly */
#define SKEIN_FLOCK_SPEED "speed" /* a number in m/s; each flies so fast, in a direction of its own */
#define SKEIN_FLOCK_SWIRL "swirl" /* a number in m/s; and all of them so, about the vertical through the middle */
#define SKEIN_FLOCK_VELOCITY "velocity" /* three numbers in m/s; and all of them so, besides */
#define SKEIN_FLOCK_MASS "mass" /* a number in kg; of each */
#define SKEIN_FLOCK_SEED "seed" /* a whole number; another one strews them differently */

/* ---- constraints ---- */

/* of every constraint */
#define SKEIN_CONSTRAINT_NAME "name" /* a text; for paths and messages */
#define SKEIN_CONSTRAINT_ENABLED "enabled" /* true or false; false: as if it were not there */
#define SKEIN_CONSTRAINT_VISIBLE "visible" /* true or false; whether it is drawn */

#define SKEIN_DISTANCE "distance" /* keeps two particles at their rest distance (a spring and damper) */
#define SKEIN_DISTANCE_STIFFNESS "stiffness" /* a number in N/m; force a metre of stretch; "infinite" is rigid (position methods only) */
#define SKEIN_DISTANCE_DAMPING "damping" /* a number in N s/m; force a metre a second of stretching; it does not slow other motion */

#define SKEIN_DIHEDRAL "dihedral" /* keeps the angle between two triangles over an edge: the edge's two ends, then the two corners beside it */
#define SKEIN_DIHEDRAL_STIFFNESS "stiffness" /* a number in N m; torque a radian; "infinite" is rigid (position methods only) */
#define SKEIN_DIHEDRAL_DAMPING "damping" /* a number in N m s; torque a radian a second */

#define SKEIN_ISOMETRIC "isometric" /* keeps two triangles flat over an edge: the edge's two ends, then the two corners beside it */
#define SKEIN_ISOMETRIC_STIFFNESS "stiffness" /* a number in N m; the bending rigidity of a sheet; "infinite" is rigid (position methods only) */
#define SKEIN_ISOMETRIC_DAMPING "damping" /* a number in N m s; the same against bending's change in time */

#define SKEIN_STRAIGHT "straight" /* keeps three particles in a straight line, the second in the middle */
#define SKEIN_STRAIGHT_STIFFNESS "stiffness" /* a number in N m; torque a radian of a small turn; "infinite" is rigid (position methods only) */
#define SKEIN_STRAIGHT_DAMPING "damping" /* a number in N m s; torque a radian a second */

#define SKEIN_TWIST "twist" /* keeps the four corners around a parallelogram in one plane */
#define SKEIN_TWIST_STIFFNESS "stiffness" /* a number in N m; torque a radian of a small twist; "infinite" is rigid (position methods only) */
#define SKEIN_TWIST_DAMPING "damping" /* a number in N m s; torque a radian a second */

#define SKEIN_AREA "area" /* keeps the area of a triangle of particles */
#define SKEIN_AREA_STIFFNESS "stiffness" /* a number in N/m3; force over length and square metre of change; "infinite" is rigid (position methods only) */
#define SKEIN_AREA_DAMPING "damping" /* a number in N s/m3; the same against the area's change in time */

#define SKEIN_VOLUME "volume" /* keeps the volume of a tetrahedron of particles */
#define SKEIN_VOLUME_STIFFNESS "stiffness" /* a number in Pa/m3; pressure a cubic metre of change; "infinite" is rigid (position methods only) */
#define SKEIN_VOLUME_DAMPING "damping" /* a number in Pa s/m3; the same against the volume's change in time */

#define SKEIN_ANGLE "angle" /* keeps the angle at the second of three particles */
#define SKEIN_ANGLE_STIFFNESS "stiffness" /* a number in N m; torque a radian; "infinite" is rigid (position methods only) */
#define SKEIN_ANGLE_DAMPING "damping" /* a number in N m s; torque a radian a second */

#define SKEIN_ATTACHMENT "attachment" /* ties a particle to its place on a triangle: the particle, then the three corners */
#define SKEIN_ATTACHMENT_STIFFNESS "stiffness" /* a number in N/m; force a metre from its place; "infinite" is rigid (position methods only) */
#define SKEIN_ATTACHMENT_DAMPING "damping" /* a number in N s/m; the same against the way's change in time */

#define SKEIN_FORMULA "formula" /* any function of up to eight particles that wants to be 0, or at least 0 */
#define SKEIN_FORMULA_CONSTRAINT "constraint" /* a text; a formula of p0 to p7 and t that wants to be 0, or `a >= b`; rest(...) is taken when it is made */
#define SKEIN_FORMULA_STIFFNESS "stiffness" /* a number in J; twice the energy where the formula is 1; "infinite" is rigid (position methods only) */
#define SKEIN_FORMULA_DAMPING "damping" /* a number in J s; against the formula's change in time, as stiffness is against its value */

#define SKEIN_ENERGY "energy" /* any energy of up to eight particles */
#define SKEIN_ENERGY_ENERGY "energy" /* a text; a formula of p0 to p7 and t, in joules; position methods need it to be 0 at the least */
#define SKEIN_ENERGY_SCALE "scale" /* a number; a factor of the energy */

#define SKEIN_ENCLOSED_VOLUME "enclosed_volume" /* keeps the volume inside a closed surface of triangles */
#define SKEIN_ENCLOSED_VOLUME_STIFFNESS "stiffness" /* a number in Pa/m3; pressure a cubic metre of change; "infinite" is rigid (position methods only) */
#define SKEIN_ENCLOSED_VOLUME_DAMPING "damping" /* a number in Pa s/m3; the same against the volume's change in time */
#define SKEIN_ENCLOSED_VOLUME_INFLATION "inflation" /* a number; the volume that it wants, by what it was when it was added: 1.2 blows it up by a fifth */

#define SKEIN_PRESSURE "pressure" /* gas inside a closed surface of triangles */
#define SKEIN_PRESSURE_PRESSURE "pressure" /* a number in Pa; of the gas, at the volume that the surface had when it was added */
#define SKEIN_PRESSURE_OUTSIDE "outside" /* a number in Pa; of the air around: 101325 at sea level */
#define SKEIN_PRESSURE_EXPONENT "exponent" /* a number; pressure times volume to this power stays: 1 at one temperature, 1.4 for quick changes of air, 0 for a pressure that stays */
#define SKEIN_PRESSURE_DAMPING "damping" /* a number in Pa s/m3; pressure against the volume's change in time */

/* ---- forces ---- */

/* of every force */
#define SKEIN_FORCE_NAME "name" /* a text; for paths and messages */
#define SKEIN_FORCE_ENABLED "enabled" /* true or false; false: as if it were not there */
#define SKEIN_FORCE_VISIBLE "visible" /* true or false; whether it is drawn */
#define SKEIN_FORCE_ON "on" /* a text; the names of the bodies, or of groups of them, that it acts on, commas between them; empty: every particle */

#define SKEIN_GRAVITY "gravity" /* weight: the same acceleration for every particle */
#define SKEIN_GRAVITY_ACCELERATION "acceleration" /* three numbers in m/s2; the free fall's acceleration */

#define SKEIN_WIND "wind" /* the same force on every particle, whatever its mass */
#define SKEIN_WIND_FORCE "force" /* three numbers in N; the force on each particle */

#define SKEIN_SURFACE_WIND "surface_wind" /* wind by triangle: lift and drag from its normal and its velocity through the air */
#define SKEIN_SURFACE_WIND_VELOCITY "velocity" /* three numbers in m/s; the air's velocity; 0 is still air */
#define SKEIN_SURFACE_WIND_DRAG "drag" /* a number; coefficient of the part along the wind */
#define SKEIN_SURFACE_WIND_LIFT "lift" /* a number; coefficient of the part along the normal */
#define SKEIN_SURFACE_WIND_DENSITY "density" /* a number in kg/m3; of the air */

#define SKEIN_DRAG "drag" /* air damping, linear and quadratic in the speed */
#define SKEIN_DRAG_LINEAR "linear" /* a number in N s/m; air damping K of each particle: F = -K v */
#define SKEIN_DRAG_RATE "rate" /* a number in 1/s; the same by mass: speed decays as exp(-rate t) at any resolution */
#define SKEIN_DRAG_QUADRATIC "quadratic" /* a number in N s2/m2; grows with the square of the speed */

#define SKEIN_SEPARATION "separation" /* neighbours closer than a radius push each other apart */
#define SKEIN_SEPARATION_RADIUS "radius" /* a number in m; how near is too near */
#define SKEIN_SEPARATION_STRENGTH "strength" /* a number in N; the push of two particles in one place */

#define SKEIN_FLOCKING "flocking" /* neighbours push apart, fly along or draw together, by how far they are */
#define SKEIN_FLOCKING_SEPARATION "separation" /* a number in m; width of the zone whose neighbours push away */
#define SKEIN_FLOCKING_ALIGNMENT "alignment" /* a number in m; and of the next zone, whose neighbours are flown along with */
#define SKEIN_FLOCKING_COHESION "cohesion" /* a number in m; and of the last, at whose edges neighbours are drawn to; 0, 0, 0: no neighbours */
#define SKEIN_FLOCKING_MEASURE "measure" /* a word; how far through the zones a neighbour is: by its distance, or by the square of it */
#define SKEIN_FLOCKING_MEASURE_DISTANCE "distance"
#define SKEIN_FLOCKING_MEASURE_DISTANCE_2 "distance^2"
#define SKEIN_FLOCKING_STRENGTH "strength" /* a number in m/s2; how strongly each neighbour counts */
#define SKEIN_FLOCKING_VIEW "view" /* a number in degrees; the angle that each sees, round its direction of flight; 360: all round */
#define SKEIN_FLOCKING_NEAREST "nearest" /* a whole number; of the neighbours in reach only so many count, the nearest; 0: all */
#define SKEIN_FLOCKING_NEIGHBOURS "neighbours" /* a text; the names of the bodies, or of groups of them, that it looks at, commas between them; empty: those that it is `on` */
#define SKEIN_FLOCKING_FORMULA_TOWARDS "formula.towards" /* a text; the weight of a neighbour along the direction to it, as a formula of `relative_distance` (0 beside it, 1 at the reach); where there is a formula, the zones only say how far the rule reaches */
#define SKEIN_FLOCKING_FORMULA_ALONG "formula.along" /* a text; the weight along its direction of flight, likewise */

#define SKEIN_ATTRACTION "attraction" /* draws everything to a centre, equally at any distance; flatter in the vertical */
#define SKEIN_ATTRACTION_CENTRE "centre" /* three numbers in m; where everything is drawn to */
#define SKEIN_ATTRACTION_STRENGTH "strength" /* a number in m/s2; the acceleration, at any distance */
#define SKEIN_ATTRACTION_FLATNESS "flatness" /* a number; how many times more the vertical counts: over 1 makes a ring, 1 is the same all round */

#define SKEIN_PREDATOR "predator" /* what is near flees from it: a place, a line of sight or a particle */
#define SKEIN_PREDATOR_POSITION "position" /* three numbers in m; where it is, where no particle is given */
#define SKEIN_PREDATOR_LINE "line" /* three numbers; the line of sight that it acts along, at any depth; 0 0 0: it is in one place */
#define SKEIN_PREDATOR_PARTICLE "particle" /* a whole number; the particle that it is; -1: none */
#define SKEIN_PREDATOR_RADIUS "radius" /* a number in m; how far it is feared */
#define SKEIN_PREDATOR_STRENGTH "strength" /* a number in m/s2; the acceleration away when it is very near */
#define SKEIN_PREDATOR_ALARM "alarm" /* a number in m/s; how much higher the speed limit is for those who flee */

#define SKEIN_LOOKOUT "lookout" /* looks ahead, and steers clear of every collider */
#define SKEIN_LOOKOUT_AHEAD "ahead" /* a number in s; how far ahead, as a time of flight */
#define SKEIN_LOOKOUT_CLEARANCE "clearance" /* a number in m; nearer to a collider than this is too near */
#define SKEIN_LOOKOUT_STRENGTH "strength" /* a number in m/s2; the acceleration away where the way leads into one */

#define SKEIN_SPEED_LIMIT "speed_limit" /* nothing is faster than this */
#define SKEIN_SPEED_LIMIT_LIMIT "limit" /* a number in m/s; the highest speed; what flees may be faster */

#define SKEIN_TURN_LIMIT "turn_limit" /* nothing turns faster or flies steeper than this */
#define SKEIN_TURN_LIMIT_TURN "turn" /* a number in degrees/s; what steers turns nothing faster than this */
#define SKEIN_TURN_LIMIT_CLIMB "climb" /* a number in degrees; nothing flies steeper, up or down; 90: no limit */

#define SKEIN_BOUNDS "bounds" /* a box or a sphere that is not left */
#define SKEIN_BOUNDS_SHAPE "shape" /* a word; what is not left */
#define SKEIN_BOUNDS_SHAPE_BOX "box"
#define SKEIN_BOUNDS_SHAPE_SPHERE "sphere"
#define SKEIN_BOUNDS_EDGE "edge" /* a word; what leaves is turned back, or comes in at the other side of the box */
#define SKEIN_BOUNDS_EDGE_WALL "wall"
#define SKEIN_BOUNDS_EDGE_PERIODIC "periodic"
#define SKEIN_BOUNDS_CENTRE "centre" /* three numbers in m; its middle */
#define SKEIN_BOUNDS_SIZE "size" /* three numbers in m; of the box, from side to side */
#define SKEIN_BOUNDS_RADIUS "radius" /* a number in m; of the sphere */

#define SKEIN_FORCE_FIELD "force_field" /* any force that is a formula of place, velocity and time */
#define SKEIN_FORCE_FIELD_FORCE "force" /* a text; a vector, as a formula of p, v and t */
#define SKEIN_FORCE_FIELD_PER "per" /* a word; mass: the formula is an acceleration, m/s2; particle: a force on each, N */
#define SKEIN_FORCE_FIELD_PER_MASS "mass"
#define SKEIN_FORCE_FIELD_PER_PARTICLE "particle"

#define SKEIN_POTENTIAL "potential" /* any potential energy of place (and time) that is a formula */
#define SKEIN_POTENTIAL_ENERGY "energy" /* a text; a number, as a formula of p and t: the force goes down its slope */
#define SKEIN_POTENTIAL_PER "per" /* a word; mass: the formula is J/kg, as g times a height; particle: J for each */
#define SKEIN_POTENTIAL_PER_MASS "mass"
#define SKEIN_POTENTIAL_PER_PARTICLE "particle"

#define SKEIN_CONTACT "contact" /* surfaces and ropes neither pass through each other nor through themselves; colliders meet all of them */
#define SKEIN_CONTACT_THICKNESS "thickness" /* a number in m; how near surfaces come to each other; less where a body's own vertices are nearer as it was built */
#define SKEIN_CONTACT_FRICTION "friction" /* a number; coefficient of friction between them */
#define SKEIN_CONTACT_RECOVERY "recovery" /* a number in m/s; how fast surfaces that have gone through each other are led apart; 0: they stay so */
#define SKEIN_CONTACT_MORE_SUBSTEPS "more_substeps" /* a whole number; xpbd and pbd, where bodies near others or colliders by over half a thickness a substep, or pins are led past what hangs from them by over two: up to so many times as many; 1: never */
#define SKEIN_CONTACT_IGNORE "ignore" /* a text; pairs of bodies, or of groups of them, that do not meet, by their names, commas between them: "cape:shirt, cape:cape" */

/* ---- colliders ---- */

/* of every collider */
#define SKEIN_COLLIDER_NAME "name" /* a text; for paths and messages */
#define SKEIN_COLLIDER_ENABLED "enabled" /* true or false; false: as if it were not there */
#define SKEIN_COLLIDER_VISIBLE "visible" /* true or false; whether it is drawn */
#define SKEIN_COLLIDER_ON "on" /* a text; the names of the bodies, or of groups of them, that it meets, commas between them; empty: every particle */
#define SKEIN_COLLIDER_THICKNESS "thickness" /* a number in m; particles are kept so far off */
#define SKEIN_COLLIDER_FRICTION "friction" /* a number; Coulomb's coefficient, at rest and sliding */
#define SKEIN_COLLIDER_RECOVERY "recovery" /* a number in m/s; what begins inside comes out at this speed, and is not thrown: the way out is no velocity */
#define SKEIN_COLLIDER_RESTITUTION "restitution" /* a number; speed after a bounce over speed before */
#define SKEIN_COLLIDER_MOTION_VELOCITY "motion.velocity" /* three numbers in m/s; it moves so from motion.start on */
#define SKEIN_COLLIDER_MOTION_AXIS "motion.axis" /* three numbers; axis of the spin, through its own point */
#define SKEIN_COLLIDER_MOTION_SPIN "motion.spin" /* a number in rad/s; angular speed from motion.start on */
#define SKEIN_COLLIDER_MOTION_START "motion.start" /* a number in s; when the motion begins */

#define SKEIN_PLANE "plane" /* everything below a plane of any normal and offset */
#define SKEIN_PLANE_NORMAL "normal" /* three numbers; out of the solid; any length but 0 */
#define SKEIN_PLANE_OFFSET "offset" /* a number in m; distance of the plane from the origin along it */

#define SKEIN_SPHERE "sphere" /* a ball, solid inside */
#define SKEIN_SPHERE_CENTRE "centre" /* three numbers in m; the centre, before any motion */
#define SKEIN_SPHERE_RADIUS "radius" /* a number in m; the radius */
#define SKEIN_SPHERE_MASS "mass" /* a number in kg; instead of the restitution: particles bounce as off a ball of that mass, which stays; 0 is none */

#define SKEIN_BOWL "bowl" /* the inside of a ball: what is in it stays in it */
#define SKEIN_BOWL_CENTRE "centre" /* three numbers in m; the middle, before any motion */
#define SKEIN_BOWL_RADIUS "radius" /* a number in m; the radius */
#define SKEIN_BOWL_MASS "mass" /* a number in kg; instead of the restitution: particles bounce as off a wall of that mass, which stays; 0 is none */

#define SKEIN_CAPSULE "capsule" /* a rod with round ends: a ball drawn along a line */
#define SKEIN_CAPSULE_FROM "from" /* three numbers in m; one end of its line, before any motion */
#define SKEIN_CAPSULE_TO "to" /* three numbers in m; the other end */
#define SKEIN_CAPSULE_RADIUS "radius" /* a number in m; around the line */

#define SKEIN_BOX "box" /* a box of any size, turned as one likes */
#define SKEIN_BOX_CENTRE "centre" /* three numbers in m; the middle, before any motion */
#define SKEIN_BOX_SIZE "size" /* three numbers in m; along x, y and z before it is turned */
#define SKEIN_BOX_ROTATION "rotation" /* three numbers in deg; turned about x, then y, then z, before any motion */

#define SKEIN_MESH "mesh" /* what a mesh encloses, or an open one from both sides; moved as a whole, or by a program */
#define SKEIN_MESH_MESH "mesh" /* a text; file of the mesh, OBJ, OFF, PLY, STL or glTF (in scenes; a program passes the mesh itself) */
#define SKEIN_MESH_POSITION "position" /* three numbers in m; where the mesh's origin is put, before any motion */
#define SKEIN_MESH_ROTATION "rotation" /* three numbers in deg; turned about x, then y, then z, before any motion */
#define SKEIN_MESH_SCALE "scale" /* a number; factor on the mesh's coordinates */

#define SKEIN_FIELD "field" /* what a mesh encloses, by distances sampled from it once: cheap to ask, and round at edges by a part of a cell */
#define SKEIN_FIELD_MESH "mesh" /* a text; file of the mesh, OBJ, OFF, PLY, STL or glTF (in scenes; a program passes the mesh itself) */
#define SKEIN_FIELD_POSITION "position" /* three numbers in m; where the mesh's origin is put, before any motion */
#define SKEIN_FIELD_ROTATION "rotation" /* three numbers in deg; turned about x, then y, then z, before any motion */
#define SKEIN_FIELD_SCALE "scale" /* a number; factor on the mesh's coordinates */
#define SKEIN_FIELD_CELL "cell" /* a number in m; side of the cubes that distances are sampled in; 0: a 32nd of the mesh's longest side */

#define SKEIN_FORMULA "formula" /* any surface that a formula describes, also one that moves and changes */
#define SKEIN_FORMULA_SURFACE "surface" /* a text; a formula of p and t: over 0 where particles may be, under 0 in the solid; best a distance */
#define SKEIN_FORMULA_CENTRE "centre" /* three numbers in m; where the formula's p is 0, before any motion */
#define SKEIN_FORMULA_ROTATION "rotation" /* three numbers in deg; turned about x, then y, then z, before any motion */

/* ---- methods ---- */

#define SKEIN_EXPLICIT_EULER "explicit_euler" /* positions and velocities both from the start of the substep: first order, gains energy */
#define SKEIN_EXPLICIT_EULER_SUBSTEPS "substeps" /* a whole number; equal parts that a step is cut into */

#define SKEIN_SYMPLECTIC_EULER "symplectic_euler" /* forces, then velocities, then positions; needs small substeps for stiff springs */
#define SKEIN_SYMPLECTIC_EULER_SUBSTEPS "substeps" /* a whole number; equal parts that a step is cut into */

#define SKEIN_LOOKAHEAD_EULER "lookahead_euler" /* explicit, with the derivative at the predicted end of the substep: first order, loses energy */
#define SKEIN_LOOKAHEAD_EULER_SUBSTEPS "substeps" /* a whole number; equal parts that a step is cut into */

#define SKEIN_MIDPOINT "midpoint" /* the derivative at the middle of the substep: second order, two evaluations, gains a little energy */
#define SKEIN_MIDPOINT_SUBSTEPS "substeps" /* a whole number; equal parts that a step is cut into */

#define SKEIN_LEAPFROG "leapfrog" /* half a kick, a drift, half a kick: second order, keeps energy; the choice for undamped motion */
#define SKEIN_LEAPFROG_SUBSTEPS "substeps" /* a whole number; equal parts that a step is cut into */

#define SKEIN_RK4 "rk4" /* Runge-Kutta of fourth order: four evaluations a substep, very exact on smooth motion */
#define SKEIN_RK4_SUBSTEPS "substeps" /* a whole number; equal parts that a step is cut into */

#define SKEIN_BACKWARD_EULER "backward_euler" /* implicit: solves for the velocity whose forces lead to it; stable at any stiffness */
#define SKEIN_BACKWARD_EULER_SUBSTEPS "substeps" /* a whole number; equal parts that a step is cut into */
#define SKEIN_BACKWARD_EULER_TOLERANCE "tolerance" /* a number; a substep is solved when its residual is so small a share of its start, or all rounding */
#define SKEIN_BACKWARD_EULER_NEWTON_ITERATIONS "newton_iterations" /* a whole number; of Newton's method in a substep, at most */
#define SKEIN_BACKWARD_EULER_CG_ITERATIONS "cg_iterations" /* a whole number; of conjugate gradients in one of those, at most */
#define SKEIN_BACKWARD_EULER_PRECONDITIONER "preconditioner" /* a word; what shortens conjugate gradients: each particle's own block, or a sparse factor of the whole matrix */
#define SKEIN_BACKWARD_EULER_PRECONDITIONER_BLOCKS "blocks"
#define SKEIN_BACKWARD_EULER_PRECONDITIONER_CHOLESKY "cholesky"

#define SKEIN_XPBD "xpbd" /* positions corrected constraint by constraint; stable at any stiffness */
#define SKEIN_XPBD_SUBSTEPS "substeps" /* a whole number; equal parts that a step is cut into, fewer where steps get shorter, more where contact is fast (more_substeps); more is firmer and more exact */
#define SKEIN_XPBD_ITERATIONS "iterations" /* a whole number; passes over the constraints in a substep; more substeps are better spent */

#define SKEIN_PBD "pbd" /* positions corrected by a share of each error; passes forget each other and share the stiffness */
#define SKEIN_PBD_SUBSTEPS "substeps" /* a whole number; equal parts that a step is cut into, fewer where steps get shorter, more where contact is fast (more_substeps); more is firmer and more exact */
#define SKEIN_PBD_ITERATIONS "iterations" /* a whole number; passes over the constraints in a substep, which share the stiffness; stiff ones come out stiffer */
#define SKEIN_PBD_INERTIA "inertia" /* true or false; false: constraints move positions, and pins go their way; other velocities, and forces, are as if they were not */
// clang-format on

#endif
