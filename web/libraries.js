// What the scripts of the report take from three.js and uPlot.
import {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, LinearFilter, LineSegments, Mesh, OrthographicCamera,
  PerspectiveCamera, Raycaster, Scene, ShaderMaterial, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";

globalThis.uPlot = uPlot;
globalThis.THREE = {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, LinearFilter, LineSegments, Mesh, OrbitControls,
  OrthographicCamera, PerspectiveCamera, Raycaster, Scene, ShaderMaterial, Vector2, Vector3, WebGLRenderer,
};
