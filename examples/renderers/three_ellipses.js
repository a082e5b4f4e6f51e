// For three.js r187 (WebGL): a MeshPhysicalMaterial with a map of normals and one of anisotropy, as
// `hshfit export --target mips` writes them, drawn with the ellipse that they stand for.
//
//     material = withEllipses(new MeshPhysicalMaterial({ normalMap, roughnessMap, anisotropyMap, … }));
//
// axes: three.js takes the axes of the anisotropy from the surface, so that highlights stay where the flat
// surface has them; here they are perpendicular to the map's normal.
// energy: three.js restores the light that a lobe loses to multiple scattering, and looks the loss up by the
// roughness across the axis alone. An ellipse loses within 0.02 of what a round lobe with the mean of both
// squared widths loses, for views up to 45 degrees from the normal and widths up to 0.6, and is looked up as that.
import { ShaderChunk } from 'three';

const edits = {
  axes: [
    ['lights_physical_fragment',
      'material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;',
      `vec3 surfaceT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
       material.anisotropyT = normalize( surfaceT - dot( surfaceT, normal ) * normal );`],
    ['lights_physical_fragment',
      'material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;',
      'material.anisotropyB = cross( normal, material.anisotropyT );'],
  ],
  energy: [
    ['lights_fragment_begin',
      'texture2D( dfgLUT, vec2( material.roughness, dotNVms ) )',
      `texture2D( dfgLUT, vec2( pow( 0.5 * ( pow2( material.alphaT ) + pow2( pow2( material.roughness ) ) ),
         0.25 ), dotNVms ) )`],
  ],
};

export function withEllipses(material, { axes = true, energy = true } = {}) {
  const wanted = [...(axes ? edits.axes : []), ...(energy ? edits.energy : [])];
  const chunks = {};
  for (const [name, from, to] of wanted) {
    const text = chunks[name] ?? ShaderChunk[name];
    if (!text.includes(from)) throw new Error(`this three.js has another ${name}`);
    chunks[name] = text.replace(from, to);
  }
  material.onBeforeCompile = (shader) => {
    for (const [name, text] of Object.entries(chunks))
      shader.fragmentShader = shader.fragmentShader.replace(`#include <${name}>`, text);
  };
  material.customProgramCacheKey = () => `ellipses ${axes} ${energy}`;
  return material;
}
