// Ahead of the stages of a bowl's near wall.
#define GLASS
