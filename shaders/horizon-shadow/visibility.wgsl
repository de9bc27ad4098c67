// Visibility of up to four lights, for meshes with a height map.
