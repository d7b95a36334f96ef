// What a node is: bits 0 to 2 for components that are prescribed whatever the contact does, then
// whether it is the plate's, and its contact point and one.
const IS_PRESCRIBED: u32 = 7;
const IS_PLATE: u32 = 8;
const FIRST_POINT: u32 = 16;
