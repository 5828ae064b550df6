// How wide a lobe is: alpha, or alpha along the tangent (x) and across it (y).
#ifdef ANISOTROPIC
#define WIDTH vec2
#else
#define WIDTH float
#endif
