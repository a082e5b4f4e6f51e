#version 300 es
precision highp float;
in vec3 worldPosition, worldNormal;
layout(location = 0) out vec4 outPosition;
layout(location = 1) out vec4 outNormal;
void main() {
    outPosition = vec4(worldPosition, 1.0);
    outNormal = vec4(normalize(gl_FrontFacing ? worldNormal : -worldNormal), 1.0);
}
