// The environment: sum over k of skyColour[k] ((1 + cos(gamma_k)) / 2)^power_k, gamma_k being the
// angle to skyAxis[k]. Never negative, and a polynomial of degree power_k: its SH are exact.
#define SKY_LIGHTS {{lights}}
uniform vec3 skyAxis[SKY_LIGHTS], skyColour[SKY_LIGHTS];
