// SPDX-License-Identifier: MIT
// Written by runtime/csharp/generate.py from the C headers; the test csharp.native fails where it is not what they say now.
// Types without pointers are public for all code. Structs with pointers, and functions, are in the class Native, for unsafe code.
// The headers (runtime/include/spherechain) say what each function promises; size_t is UIntPtr, a function pointer an IntPtr.
using System;
using System.Runtime.InteropServices;

namespace Spherechain
{
    public enum Radius : int  // sc_radius
    {
        /// <summary>the default: reaches most of the skin that the sphere stands for</summary>
        Detect = 0,
        /// <summary>the paper's</summary>
        Fit = 1,
    }

    public enum Target : int  // sc_target
    {
        /// <summary>the best that the build has and the machine runs</summary>
        Best = 0,
        Scalar = 1,
        Sse2 = 2,
        Ssse3 = 3,
        /// <summary>with BMI2 and FMA</summary>
        Avx2 = 4,
        /// <summary>F, VL, DQ, BW, CD</summary>
        Avx512 = 5,
        Neon = 6,
        /// <summary>WebAssembly's SIMD of 128 bits</summary>
        Wasm = 7,
    }

    public enum Code : int  // sc_code
    {
        Ok = 0,
        /// <summary>an output buffer is too small; the job's counts say how many entries there are</summary>
        Overflow = 1,
        /// <summary>the field is required and null</summary>
        Null = 2,
        /// <summary>the field's memory is not aligned as its type</summary>
        Misaligned = 3,
        /// <summary>the field has fewer entries than the call needs</summary>
        TooSmall = 4,
        /// <summary>a stride below the size of an entry, or no multiple of 4</summary>
        BadStride = 5,
        /// <summary>the field has a value that does not exist</summary>
        BadValue = 6,
        /// <summary>the field is written and overlaps another buffer of the call</summary>
        Aliased = 7,
        /// <summary>the asset was never opened</summary>
        NotOpen = 8,
        /// <summary>the asset has no data for this: no bones, or no triangles</summary>
        NotInAsset = 9,
        /// <summary>this build or this machine lacks the instruction set</summary>
        UnsupportedTarget = 10,
        /// <summary>the bytes are no .sphc file</summary>
        NotAnAsset = 11,
        /// <summary>the asset needs a later library, or is older than release 0.1.0</summary>
        OtherVersion = 12,
        /// <summary>the asset is cut short or damaged</summary>
        Corrupt = 13,
        /// <summary>the program was compiled with other headers than the library</summary>
        WrongAbi = 14,
        /// <summary>these are not the vertices that the asset was baked from</summary>
        WrongSource = 15,
        /// <summary>the skeleton lacks a bone of the asset</summary>
        NoSuchBone = 16,
        /// <summary>a bone's inverse bind matrix, or its place at rest, differs from the asset's</summary>
        OtherBind = 17,
        /// <summary>an allocation failed (of a model, a body or a HostCrowd)</summary>
        NoMemory = 18,
        /// <summary>no CUDA device, or no driver for one</summary>
        NoDevice = 19,
        /// <summary>the CUDA device or its driver reported an error</summary>
        DeviceFailed = 20,
        /// <summary>the asset does not fit into a block's memory on the CUDA device</summary>
        DeviceTooSmall = 21,
    }

    public enum Field : int  // sc_field
    {
        None = 0,
        Asset = 1,
        Data = 2,
        Bones = 3,
        BoneCount = 4,
        BoneLayout = 5,
        BoneStride = 6,
        Vertices = 7,
        VertexCount = 8,
        VertexStride = 9,
        MorphWeights = 10,
        Radius = 11,
        Target = 12,
        Spheres = 13,
        Table = 14,
        IgnoredPairs = 15,
        Pairs = 16,
        Bits = 17,
        Scope = 18,
        Candidates = 19,
        Scratch = 20,
        Parts = 21,
        Triangles = 22,
        Instances = 23,
        InstanceStride = 24,
        Tasks = 25,
        Counts = 26,
        Joints = 27,
        Index = 28,
        Output = 29,
        Stream = 30,
        SkinTable = 31,
        Contacts = 32,
        Previous = 33,
        Penetrations = 34,
        Rule = 35,
        IgnoredParts = 36,
        Bodies = 37,
        Layers = 38,
        Ignored = 39,
        Floor = 40,
        End = 41,
        Blend = 42,
        Parents = 43,
        Tolerance = 44,
        Transform = 45,
        Allocator = 46,
        Query = 47,
        PartPairs = 48,
        StructSize = 49,
    }

    public enum PenetrationClass : int  // sc_penetration_class
    {
        /// <summary>the two spots touch in the rest pose, too</summary>
        Rest = 0,
        /// <summary>another layer of the same place (a garment on the body), or most of it is hidden</summary>
        Shell = 1,
        /// <summary>shallow; or up to touch_times deeper, no fold, and little is swallowed</summary>
        Touch = 2,
        /// <summary>neighbours on the body meet near their joint: an elbow, a groin</summary>
        Fold = 3,
        /// <summary>a fold within one piece of skin that is deep: a fault</summary>
        DeepFold = 4,
        /// <summary>everything else: a fault</summary>
        Penetration = 5,
        /// <summary>the middle of the one part is inside the other, or a fault goes through it</summary>
        Inside = 6,
    }

    public enum Relation : int  // sc_relation
    {
        Apart = 0,
        /// <summary>one hangs on a part that hangs on the other: a thigh and the abdomen</summary>
        Near = 1,
        /// <summary>both hang on the same third part</summary>
        Siblings = 2,
        /// <summary>one hangs on the other, or a part meets itself</summary>
        Joined = 3,
        /// <summary>they are of two bodies</summary>
        TwoBodies = 4,
    }

    public enum Scope : int  // sc_scope
    {
        /// <summary>of two spheres that are not ignored: no neighbours on the body. Layers of one place are left out: a garment on the body, the skin below it</summary>
        Apart = 0,
        /// <summary>of one sphere, or of two that are ignored: folds of elbow and knee; 40 times dearer</summary>
        Neighbours = 1,
        All = 2,
        /// <summary>as SC_SCOPE_APART, and layers of one place</summary>
        Layers = 3,
    }

    public enum MatrixLayout : int  // sc_matrix_layout
    {
        /// <summary>refused</summary>
        LayoutUnset = 0,
        /// <summary>12 floats: three rows of four</summary>
        Rows3x4 = 1,
        /// <summary>16 floats: four rows, the last 0 0 0 1 and not read</summary>
        Rows4x4 = 2,
        /// <summary>16 floats: four columns: glTF, OpenGL, glm, Unity</summary>
        Columns4x4 = 3,
        /// <summary>12 floats: four columns of three</summary>
        Columns3x4 = 4,
    }

    public struct Vec3  // sc_vec3
    {
        public float X, Y, Z;
    }

    public struct Sphere  // sc_sphere
    {
        public float X, Y, Z, Radius;
    }

    public struct Pair  // sc_pair
    {
        public uint A, B;
    }

    public struct Status  // sc_status
    {
        public Code Code;
        public Field Field;
    }

    public struct RestSphere  // sc_rest_sphere
    {
        public Vec3 Center;
        /// <summary>the fit radius; &gt; 0</summary>
        public float Radius;
        /// <summary>&gt;= 0</summary>
        public float DetectRadius;
        /// <summary>of a torso sphere: the half that it stands for, as sc_part.side</summary>
        public int Side;
        /// <summary>below sc_asset_info.region_count</summary>
        public uint Region;
        /// <summary>of a torso sphere: its height, from the bottom up; else -1</summary>
        public int Level;
        /// <summary>that most of its triangles are of</summary>
        public uint Part;
    }

    public struct SourceBuffer  // sc_source_buffer
    {
        /// <summary>glTF: indices in the file; other formats: the importer's mesh, and 0</summary>
        public uint Mesh, Primitive;
        public uint FirstVertex, VertexCount;
        /// <summary>sc_hash_positions() of its positions as the file has them</summary>
        public ulong Hash;
    }

    public struct Measures  // sc_measures
    {
        /// <summary>&gt; 0: the way out; the pose's units</summary>
        public float Depth;
        /// <summary>of the one part inside the other; negative: not known. The pose's units</summary>
        public float Volume;
        /// <summary>of the line where the parts cross; the pose's units</summary>
        public float ContourLength;
        /// <summary>0 to 1: the share of that line that can be seen from outside; 1 where it was not looked at</summary>
        public float Visible;
        /// <summary>0 to 1: of the triangle pairs that intersect, the share that touches at rest</summary>
        public float Touching;
        /// <summary>-1 to 1: 1 where the sides lie flat on each other</summary>
        public float Facing;
        /// <summary>between the two spots at rest, a share of the height; infinite of two bodies</summary>
        public float RestDistance;
        /// <summary>of the thinner part, there, in the pose's units; negative: not known</summary>
        public float Thickness;
        /// <summary>depth / thickness * seen length / side of a square with the area of the smaller part; negative: not known, for the class does not depend on it</summary>
        public float Extent;
        /// <summary>how long the character's height and a metre are in the pose's units</summary>
        public float Height, Metre;
        public Relation Relation;
        /// <summary>1: the two spots are of one piece of skin</summary>
        public int IsOnePiece;
        /// <summary>0 to 1: of points in the middle of `part` the share that is inside `other`; where that holds most of them, inside any part. 0 while no centre of its spheres is inside</summary>
        public float Swallowed;
        /// <summary>1: a sphere's centre is inside, and its limb comes out again on the other side</summary>
        public int Through;
        /// <summary>0</summary>
        public uint Reserved0, Reserved1, Reserved2, Reserved3;
    }

    public struct Rule  // sc_rule
    {
        /// <summary>SC_RULE_VERSION; others are refused</summary>
        public uint Version;
        /// <summary>0: the next five fields decide what is a touch. Else depth alone decides: shallower intersections are touches, deeper ones are not. In the pose's units</summary>
        public float TouchDepth;
        /// <summary>skins up to this depth only touch: touch_metres, but not less than touch_min and not more than touch_max</summary>
        public float TouchMetres, TouchMin, TouchMax;
        /// <summary>an intersection up to so many times deeper is still a touch if it is no fold and its sc_measures.extent is below `extent`</summary>
        public float TouchTimes;
        /// <summary>touch: sc_measures.extent is below this, see touch_times</summary>
        public float Extent;
        /// <summary>rest: at least this share of the triangle pairs touches at rest</summary>
        public float AtRest;
        /// <summary>shell: less than this share of the line is visible</summary>
        public float Hidden;
        /// <summary>shell: two pieces of skin whose spots are near at rest, up to that share of loose_depth</summary>
        public float Shell;
        /// <summary>fold: a joint lies between the two parts and their spots are near at rest: up to that share of fold_depth or loose_depth. Parts that hang on each other: always</summary>
        public float Fold;
        /// <summary>fold: the same of any two parts. A joint may lack a bone</summary>
        public float Neighbours;
        /// <summary>within one piece of skin. A deeper fold of spots closer than the limit is a deep fold</summary>
        public float FoldDepth;
        /// <summary>of two pieces of skin; on parts that hang on each other any depth is allowed</summary>
        public float LooseDepth;
        /// <summary>inside: at least this share of the part is swallowed; or it comes out again. From three quarters of it on the allowed depths shrink to 0</summary>
        public float Inside;
        /// <summary>0; others are refused</summary>
        public float Reserved0, Reserved1, Reserved2, Reserved3;
    }

    public struct PartContact  // sc_part_contact
    {
        /// <summary>part_a &lt;= part_b; equal where a part meets itself</summary>
        public uint PartA, PartB;
        /// <summary>&gt;= 1</summary>
        public uint TrianglePairs;
        /// <summary>a box around the triangles that intersect; the pose's space</summary>
        public Vec3 Low, High;
    }

    public struct TriangleContact  // sc_triangle_contact
    {
        /// <summary>the source's numbers, triangle_a &lt; triangle_b</summary>
        public uint TriangleA, TriangleB;
        public uint SphereA, SphereB;
        public uint PartA, PartB;
        /// <summary>the segment in which they cross, rounded. If they lie in one plane: the longest piece of an edge inside the other triangle</summary>
        public Vec3 From, To;
    }

    public struct SkinPoint  // sc_skin_point
    {
        /// <summary>the pose's space</summary>
        public Vec3 Position;
        /// <summary>the source's number</summary>
        public uint Triangle;
        /// <summary>of the triangle's corners; their sum is 1</summary>
        public float Weights0, Weights1, Weights2;
    }

    public struct Penetration  // sc_penetration
    {
        public uint Part, Other;
        /// <summary>moves `part`, in the order of the model's joints; SC_NO_JOINT where none does</summary>
        public uint Joint;
        public PenetrationClass Kind;
        public Vec3 Direction;
        /// <summary>how much deeper than the rule allows, the less the less of it can be seen; 0: not deeper. It is continuous in `measures`, and does not depend on `previous`</summary>
        public float FaultDepth;
        /// <summary>measures.depth; up to 1.5 times as much where `previous` keeps the direction. While a part goes inside, from 75 to 100 % of sc_rule.inside, depth lies between two ways out; this is one of them</summary>
        public float Distance;
        /// <summary>of the line where the parts cross; of the ground: of the box</summary>
        public Vec3 Centre;
        /// <summary>a box around that line; of the ground: around the skin below it</summary>
        public Vec3 Low, High;
        /// <summary>the points that part last; deepest_other - deepest = distance * direction</summary>
        public SkinPoint Deepest, DeepestOther;
        public Measures Measures;
        /// <summary>0</summary>
        public uint Reserved0, Reserved1, Reserved2, Reserved3;
    }

    public struct StepContact  // sc_step_contact
    {
        public uint PartA, PartB;
        /// <summary>1: they intersect in that pose: ask for its contacts</summary>
        public int AtStart, AtEnd;
        /// <summary>the first time at which they touch; 0 with at_start</summary>
        public float Begin;
        /// <summary>the last time; 1 with at_end. They may part and meet again before it</summary>
        public float End;
        /// <summary>these touch at `begin`; the source's numbers; SC_NO_TRIANGLE with at_start</summary>
        public uint TriangleA, TriangleB;
        /// <summary>where these triangles touch; zero with at_start</summary>
        public Vec3 At;
    }

    public struct JointTransform  // sc_transform
    {
        public Vec3 Translation;
        /// <summary>a quaternion: x, y, z, w; of about unit length</summary>
        public float Rotation0, Rotation1, Rotation2, Rotation3;
        /// <summary>along its own axes; negative mirrors. There is no default: {1, 1, 1} keeps the size</summary>
        public Vec3 Scale;
    }

    public struct Triangle  // sc_triangle
    {
        /// <summary>SC_NO_PART, each: the triangle was left out of the skin, as degenerate ones are</summary>
        public uint Part, Region, Sphere;
    }

    public struct CrowdPair  // sc_crowd_pair
    {
        public uint Instance;
        /// <summary>of spheres</summary>
        public Pair Pair;
    }

    public struct ContactRow  // sc_contact_row
    {
        /// <summary>the more mobile one first, where one is</summary>
        public uint Part, Other;
        /// <summary>0: the character's own; k: other is a part of others[k - 1], or SC_FLOOR</summary>
        public uint Body;
        /// <summary>on the skin of each, in the world</summary>
        public Vec3 At, AtOther;
        /// <summary>from `other` to `part`, of unit length</summary>
        public Vec3 Normal;
        /// <summary>their distance along `normal`; negative: so deep. The pose's units, as `allowed` is</summary>
        public float Gap;
        /// <summary>how deep they may be before it is a fault; 0 of parts that have not met</summary>
        public float Allowed;
    }

    public static unsafe class Native
    {
#if (UNITY_IOS || UNITY_WEBGL) && !UNITY_EDITOR
        public const string Library = "__Internal";  // linked into the program
#else
        public const string Library = "spherechain";  // spherechain.dll, libspherechain.so, libspherechain.dylib
#endif
        const CallingConvention Cdecl = CallingConvention.Cdecl;

        public const uint AbiVersion = 18;
        public const uint AssetAlignment = 8;
        public const uint Floor = 0xFFFFFFFFu;
        public const uint NoJoint = 0xFFFFFFFFu;
        public const uint NoPart = 0xFFFFFFFFu;
        public const uint NoTriangle = 0xFFFFFFFFu;
        public const uint ResponseWords = 480;
        public const uint RuleVersion = 4;
        public const uint SideLeft = 1;
        public const uint SideRight = 2;
        // Left out: SC_WHOLE_SOURCE: its width depends on the machine: pass new UIntPtr(UIntPtr.Size == 8 ? ulong.MaxValue : uint.MaxValue).

        public unsafe struct Asset  // sc_asset
        {
            public fixed ulong Opaque[256];
        }

        public unsafe struct Bone  // sc_bone
        {
            public byte* Name;
            /// <summary>from the rest pose to the bone's space; of the asset: SC_ROWS_3X4</summary>
            public float* InverseBind;
        }

        public unsafe struct Part  // sc_part
        {
            public byte* Name;
            /// <summary>the character's own: SC_SIDE_LEFT, SC_SIDE_RIGHT, or 0: neither</summary>
            public int Side;
            /// <summary>the bone that it follows; -1 where no bone moves it</summary>
            public int Bone;
            /// <summary>the part that it hangs on; -1: none</summary>
            public int Parent;
            /// <summary>if two parts intersect, the one with the higher number goes into the other. From high to low: hand, forearm, upper arm, foot, shin, thigh, head, and the trunk's 0. Any other part has one more than its parent</summary>
            public int Mobility;
        }

        public unsafe struct AssetInfo  // sc_asset_info
        {
            public UIntPtr SphereCount, BoneCount, PartCount, MorphCount, RegionCount, SourceBufferCount;
            /// <summary>of the source</summary>
            public UIntPtr VertexCount, TriangleCount;
            /// <summary>pairs of spheres that are neighbours on the body</summary>
            public UIntPtr IgnoredPairCount;
            /// <summary>"spherechain 0.1.0"</summary>
            public byte* Writer;
            /// <summary>canonical JSON</summary>
            public byte* Settings;
            public byte* SettingsSha256;
            public byte* SourceFile;
            public byte* SourceSha256;
            /// <summary>sc_hash_positions() of the whole rest pose</summary>
            public ulong SourceRestHash;
            /// <summary>the character's own axes, as its rest pose has them: estimates, no world's axes; orthonormal, left x up = forward</summary>
            public Vec3 Origin, Left, Up, Forward;
            /// <summary>source units</summary>
            public float Height;
            public float MetresPerUnit;
            /// <summary>the pairs of ignored_pair_count; sc_pair_words() words of the asset</summary>
            public ulong* IgnoredPairs;
        }

        public unsafe struct Pose  // sc_pose
        {
            /// <summary>null: none</summary>
            public float* Bones;
            /// <summary>at least the asset's</summary>
            public UIntPtr BoneCount;
            /// <summary>required with bones</summary>
            public MatrixLayout BoneLayout;
            /// <summary>bytes from one matrix to the next; 0: side by side</summary>
            public UIntPtr BoneStride;
            /// <summary>null: nothing morphs. Goes with bones</summary>
            public float* MorphWeights;
            /// <summary>at least the asset's morph targets</summary>
            public UIntPtr MorphWeightCount;
            /// <summary>null: none; x, y, z</summary>
            public float* Vertices;
            /// <summary>at least the source's</summary>
            public UIntPtr VertexCount;
            /// <summary>bytes from one vertex to the next; 0: 12</summary>
            public UIntPtr VertexStride;
        }

        public unsafe struct Allocator  // sc_allocator
        {
            public IntPtr Allocate;
            public IntPtr Release;
            public void* User;
        }

        public unsafe struct ModelDef  // sc_model_def
        {
            public uint StructSize;
            /// <summary>of the joints that have an inverse bind matrix</summary>
            public MatrixLayout InverseBindLayout;
            /// <summary>the bytes of a .sphc file, copied</summary>
            public void* Data;
            public UIntPtr Size;
            public Bone* Joints;
            public UIntPtr JointCount;
            /// <summary>copied; null: malloc</summary>
            public Allocator* Allocator;
        }

        public unsafe struct BodyDef  // sc_body_def
        {
            public uint StructSize;
            /// <summary>1: sc_find_steps() works; it needs much memory</summary>
            public int FindsSteps;
            public UIntPtr MaxTriangles;
            /// <summary>0: 128; the worst are kept</summary>
            public UIntPtr MaxPenetrations;
            /// <summary>of all that it will meet; null: none is larger than its own model</summary>
            public IntPtr LargestOther;
            /// <summary>copied; null: the model's</summary>
            public Allocator* Allocator;
        }

        public unsafe struct Query  // sc_query
        {
            public uint StructSize;
            public Scope Scope;
            public int Full;
            /// <summary>of spheres and their pairs</summary>
            public Radius Radius;
            public ulong* IgnoredPairs;
            public ulong* IgnoredParts;
            public ulong* IgnoredPartsOfOther;
            public ulong* PartPairs;
            /// <summary>null: sc_default_rule()</summary>
            public Rule* Rule;
            /// <summary>bit k: penetrations of class k are listed; 0: faults alone</summary>
            public uint Classes;
            /// <summary>the worst so many; 0: as many as there is room for</summary>
            public UIntPtr Limit;
            public Penetration* Previous;
            public UIntPtr PreviousCount;
            /// <summary>of steps, a share of the height; 0: 0.0001</summary>
            public float Tolerance;
            /// <summary>the same answers on every one</summary>
            public Target Target;
        }

        public unsafe struct Penetrations  // sc_penetrations
        {
            public Penetration* Items;
            public UIntPtr Count, Total;
        }

        public unsafe struct Contacts  // sc_contacts
        {
            public PartContact* Parts;
            public UIntPtr PartCount;
            public Pair* Spheres;
            public UIntPtr SphereCount, SphereTotal;
            public TriangleContact* Triangles;
            public UIntPtr TriangleCount, TriangleTotal;
        }

        public unsafe struct SpherePairs  // sc_sphere_pairs
        {
            /// <summary>the asset's, in the pose</summary>
            public Sphere* Spheres;
            public UIntPtr SphereCount;
            public Pair* Pairs;
            public UIntPtr Count, Total;
        }

        public unsafe struct Ground  // sc_ground
        {
            public uint StructSize;
            public Vec3 Up;
            /// <summary>up . p = height on the plane</summary>
            public float Height;
            public IntPtr Terrain;
            public void* User;
        }

        public unsafe struct CrowdJob  // sc_crowd_job
        {
            public uint StructSize;
            public Asset* Asset;
            /// <summary>below 2^32</summary>
            public UIntPtr InstanceCount;
            public Pose Pose;
            /// <summary>or the spheres of instance 0, of refits with the same radius</summary>
            public Sphere* Spheres;
            public UIntPtr InstanceStride;
            public Radius Radius;
            public Target Target;
            /// <summary>sc_pair_words() words; null: the asset's ignored pairs</summary>
            public ulong* IgnoredPairs;
            /// <summary>sc_crowd_scratch_words() words</summary>
            public ulong* Scratch;
            public UIntPtr ScratchWords;
            public UIntPtr TaskCount;
            public IntPtr ParallelFor;
            public void* User;
            /// <summary>out: pairs of each instance; required with `pairs`, else may be null</summary>
            public uint* Counts;
            public UIntPtr CountCapacity;
            /// <summary>out: sc_pair_words() words an instance; or null</summary>
            public ulong* Bits;
            public UIntPtr BitWords;
            public ulong* PartPairs;
            /// <summary>of all instances</summary>
            public UIntPtr PartPairWords;
            /// <summary>out: sorted by instance, then pair; or null. Entries past pair_count are written too. With several tasks leave room for twice the pairs, or it takes a second pass</summary>
            public CrowdPair* Pairs;
            public UIntPtr PairCapacity;
            /// <summary>out: how many there are, also where `pairs` is too small</summary>
            public UIntPtr PairCount;
        }

        public unsafe struct SceneBody  // sc_scene_body
        {
            /// <summary>refitted; or null: the box counts</summary>
            public Sphere* Spheres;
            public UIntPtr SphereCount;
            /// <summary>without spheres: a box around the body, as sc_get_bounds() has it; finite</summary>
            public Vec3 Low, High;
            public JointTransform* Transform;
            /// <summary>below 32</summary>
            public uint Layer;
        }

        public unsafe struct SceneJob  // sc_scene_job
        {
            public uint StructSize;
            public SceneBody* Bodies;
            /// <summary>at most 2^24</summary>
            public UIntPtr BodyCount;
            public uint* Layers;
            /// <summary>bodies that never meet: a rider and his horse; sorted, each once; null: none</summary>
            public Pair* Ignored;
            public UIntPtr IgnoredCount;
            /// <summary>sc_scene_scratch_words() words; nothing is kept there between runs</summary>
            public ulong* Scratch;
            public UIntPtr ScratchWords;
            /// <summary>out: of places in `bodies`; sorted, each once; null: count only</summary>
            public Pair* Pairs;
            public UIntPtr PairCapacity;
            /// <summary>out: how many there are, also where `pairs` is too small</summary>
            public UIntPtr PairCount;
        }

        public unsafe struct ResponseDef  // sc_response_def
        {
            public uint StructSize;
            /// <summary>of each joint, before or after it; SC_NO_JOINT: none. Required</summary>
            public uint* Parents;
            public UIntPtr JointCount;
            public float* Mobility;
            /// <summary>the most that each joint is turned, in radians, up to 2; null: 1.05, 60 degrees</summary>
            public float* Budget;
            public Vec3* Hinges;
            public ulong* PartPairs;
            /// <summary>null: sc_default_rule()</summary>
            public Rule* Rule;
            /// <summary>copied; null: the body's</summary>
            public Allocator* Allocator;
        }

        public unsafe struct ResponseFrame  // sc_response_frame
        {
            public uint StructSize;
            public JointTransform* Joints;
            /// <summary>of the roots in the world; null: the identity</summary>
            public JointTransform* Place;
            /// <summary>as of sc_pose</summary>
            public float* MorphWeights;
            public UIntPtr MorphWeightCount;
            /// <summary>since the last frame; 0 is a pause, in which nothing turns on; more than 1 is 1</summary>
            public float Seconds;
            /// <summary>from 0, the full response, to 1, none: to fade it, or for the rows alone</summary>
            public float Weakness;
            public uint Rounds;
            public JointTransform* Ahead;
            public uint AheadFrames;
            /// <summary>other characters and props, as posed now; at most 8, always in this order</summary>
            public IntPtr* Others;
            public UIntPtr OtherCount;
            /// <summary>null: none</summary>
            public Ground* Ground;
            public uint* Planted;
            public UIntPtr PlantedCount;
            /// <summary>the same answers on every one</summary>
            public Target Target;
            /// <summary>how many joints were turned; 0: `joints` is as it was, bit for bit</summary>
            public uint Turned;
            /// <summary>how many were not turned as far as wanted</summary>
            public uint AtBudget;
            /// <summary>the sum of sc_penetration.fault_depth that is left, as far as it is known</summary>
            public float Remaining;
            /// <summary>in the corrected pose; valid until the next call</summary>
            public ContactRow* Rows;
            public UIntPtr RowCount;
        }

        [DllImport(Library, CallingConvention = Cdecl)] public static extern byte* sc_code_text(Code code);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern byte* sc_field_name(Field field);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern byte* sc_target_name(Target target);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Target* sc_supported_targets(UIntPtr* count);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_asset_open(Asset* asset, uint abi, void* data, UIntPtr size, byte* message, UIntPtr message_size);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern AssetInfo sc_asset_get_info(Asset* asset);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern RestSphere sc_asset_sphere(Asset* asset, UIntPtr index);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Bone sc_asset_bone(Asset* asset, UIntPtr index);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Part sc_asset_part(Asset* asset, UIntPtr index);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern byte* sc_asset_morph_name(Asset* asset, UIntPtr index);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern byte* sc_asset_region_name(Asset* asset, UIntPtr index);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern SourceBuffer sc_asset_source_buffer(Asset* asset, UIntPtr index);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern ulong sc_hash_positions(float* positions, UIntPtr count, UIntPtr stride);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_check_source(Asset* asset, UIntPtr buffer, float* positions, UIntPtr count, UIntPtr stride);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern UIntPtr sc_pair_words(Asset* asset);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern UIntPtr sc_part_words(Asset* asset);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_ignore_parts(Asset* asset, ulong* ignored_pairs, UIntPtr part, UIntPtr other, int ignored);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Rule sc_default_rule();
        [DllImport(Library, CallingConvention = Cdecl)] public static extern PenetrationClass sc_classify(Rule* rule, Measures* measures);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern byte* sc_penetration_class_name(PenetrationClass kind);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_bind_joints(Asset* asset, Bone* joints, UIntPtr joint_count, MatrixLayout inverse_bind_layout, uint* joint_of_bone, UIntPtr capacity, byte* message, UIntPtr message_size);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_gather_bones(Asset* asset, uint* joint_of_bone, Pose* palette, float* bones);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_place_bones(JointTransform* transform, float* bones, UIntPtr bone_count);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_create_model(uint abi, ModelDef* def, IntPtr* model, byte* message, UIntPtr message_size);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern void sc_destroy_model(IntPtr model);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Asset* sc_get_asset(IntPtr model);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern uint sc_get_part_joint(IntPtr model, uint part);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Triangle sc_get_triangle(IntPtr model, uint triangle);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_check_rest(IntPtr model, Pose* palette, byte* message, UIntPtr message_size);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_create_body(IntPtr model, BodyDef* def, IntPtr* body);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern void sc_destroy_body(IntPtr body);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_set_pose(IntPtr body, Pose* pose, JointTransform* place);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_find_penetrations(IntPtr body, IntPtr other, Query* query, Penetrations* found);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_find_contacts(IntPtr body, IntPtr other, Query* query, Contacts* found);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_find_sphere_pairs(IntPtr body, Query* query, SpherePairs* found);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_find_steps(IntPtr body, IntPtr other, Query* query, StepContact** steps, UIntPtr* count);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_find_in_ground(IntPtr body, Ground* ground, Query* query, Penetrations* found);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_get_bounds(IntPtr body, Vec3* low, Vec3* high);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_detect_crowd(CrowdJob* job);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern UIntPtr sc_crowd_scratch_words(Asset* asset, UIntPtr task_count);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_find_meetings(SceneJob* job);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern UIntPtr sc_scene_scratch_words(UIntPtr body_count);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_create_response(IntPtr body, ResponseDef* def, IntPtr* response);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern void sc_destroy_response(IntPtr response);
        [DllImport(Library, CallingConvention = Cdecl)] public static extern Status sc_respond(IntPtr response, ulong* state, ResponseFrame* frame);
    }
}
