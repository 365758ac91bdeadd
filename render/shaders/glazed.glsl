// Ahead of the stages of surfaces that are jelly and not cloth.
#define GLAZED
