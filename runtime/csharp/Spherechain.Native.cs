// SPDX-License-Identifier: MIT
// Written by runtime/csharp/generate.py from the C headers; the test csharp.native fails where it is not what they say now.
// Types without pointers are public for all code. Jobs and functions are in the class Native, for unsafe code. The headers
// (runtime/include/spherechain) say what each function promises; size_t is UIntPtr, and a pointer to a function an IntPtr.
using System;
using System.Runtime.InteropServices;

namespace Spherechain
{
    public enum Radius : int  // sc_radius
    {
        /// <summary>the product's: reaches what the sphere stands for</summary>
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
        /// <summary>the field has fewer entries than the call needs, or a filter's buffer another number</summary>
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
        /// <summary>the asset is of another format version: bake it again</summary>
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
        /// <summary>an allocation failed (sc_character_create and HostCrowd only)</summary>
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
        Filter = 15,
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
        TouchDepth = 35,
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
    }

    public enum Side : int  // sc_side
    {
        None = 0,
        Left = 1,
        Right = 2,
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

    public enum Scope : int  // sc_scope
    {
        /// <summary>of two spheres that are not ignored: no neighbours on the body</summary>
        Apart = 0,
        /// <summary>of one sphere, or of two that are ignored: folds of elbow and knee; 40 times dearer</summary>
        Neighbours = 1,
        All = 2,
    }

    public enum PenetrationClass : int  // sc_penetration_class
    {
        /// <summary>the two spots touch in the rest pose, too</summary>
        Rest = 0,
        /// <summary>another layer of the same place (a garment on the body), or most of it is hidden</summary>
        Shell = 1,
        /// <summary>less deep than the job's touch_depth; or no fold, and little goes in</summary>
        Touch = 2,
        /// <summary>of neighbours on the body, near the joint: an elbow, a groin</summary>
        Fold = 3,
        /// <summary>a fold of one piece of skin, deeper than 4.5 % of the character's height</summary>
        DeepFold = 4,
        /// <summary>all else: a fault</summary>
        Penetration = 5,
    }

    public enum Blend : int  // sc_blend
    {
        /// <summary>matrices, vertices and morph weights: each number on its own</summary>
        Linear = 0,
        /// <summary>joints: rotations at constant speed; translations, scales and morph weights linearly</summary>
        Slerp = 1,
        /// <summary>joints: rotations as quaternions, linearly, brought back to unit length</summary>
        Nlerp = 2,
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Vec3  // sc_vec3
    {
        public float X;
        public float Y;
        public float Z;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Sphere  // sc_sphere
    {
        public float X;
        public float Y;
        public float Z;
        public float Radius;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Pair  // sc_pair
    {
        public uint A;
        public uint B;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Status  // sc_status
    {
        public Code Code;
        public Field Field;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct RestSphere  // sc_rest_sphere
    {
        public Vec3 Center;
        /// <summary>the fit radius; &gt; 0</summary>
        public float Radius;
        /// <summary>&gt;= 0</summary>
        public float DetectRadius;
        /// <summary>of a torso sphere: the half that it stands for</summary>
        public Side Side;
        /// <summary>below sc_asset_info.region_count</summary>
        public uint Region;
        /// <summary>of a torso sphere: its height, from the bottom up; else -1</summary>
        public int Level;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct SourceBuffer  // sc_source_buffer
    {
        public uint Mesh;
        /// <summary>glTF: indices in the file; other formats: the importer's mesh, and 0</summary>
        public uint Primitive;
        public uint FirstVertex;
        public uint VertexCount;
        /// <summary>sc_hash_positions() of its positions as the file has them</summary>
        public ulong Hash;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct JointTransform  // sc_transform
    {
        public Vec3 Translation;
        /// <summary>a quaternion: x, y, z, w; of about unit length</summary>
        public float Rotation0;
        public float Rotation1;
        public float Rotation2;
        public float Rotation3;
        /// <summary>along its own axes; negative mirrors</summary>
        public Vec3 Scale;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct PartContact  // sc_part_contact
    {
        public uint PartA;
        /// <summary>part_a &lt;= part_b; equal where a part meets itself</summary>
        public uint PartB;
        /// <summary>&gt;= 1</summary>
        public uint TrianglePairs;
        public Vec3 Low;
        /// <summary>a box around the triangles that intersect; the pose's space</summary>
        public Vec3 High;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct TriangleContact  // sc_triangle_contact
    {
        public uint TriangleA;
        /// <summary>the source's numbers, triangle_a &lt; triangle_b</summary>
        public uint TriangleB;
        public uint SphereA;
        public uint SphereB;
        public uint PartA;
        public uint PartB;
        public Vec3 From;
        /// <summary>the segment in which they cross; of triangles in one plane the longest piece of an edge inside the other triangle. Rounded</summary>
        public Vec3 To;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct SkinPoint  // sc_skin_point
    {
        /// <summary>the pose's space</summary>
        public Vec3 Position;
        /// <summary>the source's number</summary>
        public uint Triangle;
        /// <summary>of the triangle's corners; their sum is 1</summary>
        public float Weights0;
        public float Weights1;
        public float Weights2;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Penetration  // sc_penetration
    {
        public uint PartA;
        /// <summary>part_a &lt;= part_b; equal where a part meets itself</summary>
        public uint PartB;
        public PenetrationClass Kind;
        /// <summary>&gt; 0: part_b, moved so far in `direction`, no longer intersects part_a. Of a part that meets itself: of the triangles that intersect</summary>
        public float Depth;
        /// <summary>unit length. Moves part_b; its negative moves part_a</summary>
        public Vec3 Direction;
        /// <summary>1: the line where the parts cross closes, and `volume` is known</summary>
        public int IsClosed;
        /// <summary>of part_b inside part_a; 0 where not closed, and with `quick`</summary>
        public float Volume;
        /// <summary>of the line where the parts cross</summary>
        public float ContourLength;
        /// <summary>0 to 1: the share of that line that can be seen from outside; with `quick` 1</summary>
        public float Visible;
        public SkinPoint DeepestA;
        /// <summary>the points that part last; deepest_a - deepest_b = depth * direction</summary>
        public SkinPoint DeepestB;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct CrowdPair  // sc_crowd_pair
    {
        public uint Instance;
        /// <summary>of spheres</summary>
        public Pair Pair;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct StepContact  // sc_step_contact
    {
        public uint PartA;
        public uint PartB;
        public int AtStart;
        /// <summary>1: they intersect there: more say sc_find_skin_contacts(), sc_find_body_contacts()</summary>
        public int AtEnd;
        /// <summary>the first time at which they touch; 0 with at_start</summary>
        public float Begin;
        /// <summary>the last time; 1 with at_end. In between they may part and meet again</summary>
        public float End;
        public uint TriangleA;
        /// <summary>that touch at `begin`, by the source's numbers; SC_NO_TRIANGLE with at_start</summary>
        public uint TriangleB;
        /// <summary>where they do; zero with at_start</summary>
        public Vec3 At;
    }

    public static unsafe class Native
    {
#if (UNITY_IOS || UNITY_WEBGL) && !UNITY_EDITOR
        public const string Library = "__Internal";  // linked into the program
#else
        public const string Library = "spherechain";  // spherechain.dll, libspherechain.so, libspherechain.dylib
#endif

        public const uint AbiVersion = 10;
        public const uint AssetAlignment = 8;
        public const uint Floor = 0xFFFFFFFFu;
        public const uint NoJoint = 0xFFFFFFFFu;
        public const uint NoTriangle = 0xFFFFFFFFu;
        // Left out: SC_WHOLE_SOURCE: its width depends on the machine: pass new UIntPtr(UIntPtr.Size == 8 ? ulong.MaxValue : uint.MaxValue).

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct Asset  // sc_asset
        {
            public fixed ulong Opaque[128];
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct Bone  // sc_bone
        {
            public byte* Name;
            /// <summary>from the rest pose to the bone's space; of the asset: SC_ROWS_3X4</summary>
            public float* InverseBind;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct Part  // sc_part
        {
            public byte* Name;
            public Side Side;
            /// <summary>the bone that it follows; -1 where no bone moves it</summary>
            public int Bone;
            /// <summary>the part that it hangs on; -1: none</summary>
            public int Parent;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct AssetInfo  // sc_asset_info
        {
            public UIntPtr SphereCount;
            public UIntPtr BoneCount;
            public UIntPtr PartCount;
            public UIntPtr MorphCount;
            public UIntPtr RegionCount;
            public UIntPtr SourceBufferCount;
            public UIntPtr VertexCount;
            /// <summary>of the source</summary>
            public UIntPtr TriangleCount;
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
            public Vec3 Origin;
            public Vec3 Left;
            public Vec3 Up;
            /// <summary>the character's own axes; orthonormal, left x up = forward</summary>
            public Vec3 Forward;
            /// <summary>source units</summary>
            public float Height;
            public float MetresPerUnit;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct Filter  // sc_filter
        {
            public ulong* Ignored;
            public UIntPtr IgnoredWords;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct DetectJob  // sc_detect_job
        {
            /// <summary>open</summary>
            public Asset* Asset;
            public Sphere* Spheres;
            /// <summary>at least the asset's</summary>
            public UIntPtr SphereCount;
            /// <summary>of the spheres: which refit made them</summary>
            public Radius Radius;
            public Target Target;
            public ulong* Table;
            public Filter* Filter;
            /// <summary>out: sorted, each once; null: count only</summary>
            public Pair* Pairs;
            public UIntPtr PairCapacity;
            /// <summary>out: bit b(b-1)/2 + a of each pair; sc_pair_words() words exactly; or null. Cheapest</summary>
            public ulong* Bits;
            public UIntPtr BitWords;
            /// <summary>out: how many there are, also where `pairs` is too small</summary>
            public UIntPtr PairCount;
        }

        [StructLayout(LayoutKind.Sequential)]
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

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct SkinContactJob  // sc_skin_contact_job
        {
            /// <summary>open, with triangles</summary>
            public Asset* Asset;
            public Pose Pose;
            public Scope Scope;
            public Target Target;
            /// <summary>1: find pairs of spheres alone; each ends at its first contact. Cheapest</summary>
            public int SpheresOnly;
            /// <summary>from sc_prepare_skin(), of this asset</summary>
            public ulong* SkinTable;
            /// <summary>null: the asset's ignored pairs</summary>
            public Filter* Filter;
            public Pair* Candidates;
            public UIntPtr CandidateCount;
            /// <summary>sc_skin_scratch_words() words; nothing is kept there between runs</summary>
            public ulong* Scratch;
            public UIntPtr ScratchWords;
            public PartContact* Parts;
            public UIntPtr PartCapacity;
            /// <summary>a = b: within one sphere's triangles</summary>
            public Pair* Spheres;
            public UIntPtr SphereCapacity;
            public TriangleContact* Triangles;
            public UIntPtr TriangleCapacity;
            public UIntPtr PartCount;
            public UIntPtr SphereCount;
            public UIntPtr TriangleCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct PenetrationJob  // sc_penetration_job
        {
            /// <summary>open, with triangles</summary>
            public Asset* Asset;
            public Pose Pose;
            public Scope Scope;
            /// <summary>the same bits on every one</summary>
            public Target Target;
            public ulong* SkinTable;
            public Filter* Filter;
            /// <summary>null: none</summary>
            public TriangleContact* Contacts;
            public UIntPtr ContactCount;
            /// <summary>null: none</summary>
            public Penetration* Previous;
            public UIntPtr PreviousCount;
            /// <summary>1: one direction, no volume, no visibility, no previous frame. For games</summary>
            public int Quick;
            /// <summary>&gt;= 0. 0: 3 mm, by the asset's metres_per_unit, but at least 0.19 % and at most 0.66 % of the height; but for folds, up to ten times that where little goes in: depth / thickness of the thinner part * seen contour / side of a square like the smaller part &lt; 0.25</summary>
            public float TouchDepth;
            /// <summary>sc_penetration_scratch_words() words; nothing is kept there between runs</summary>
            public ulong* Scratch;
            public UIntPtr ScratchWords;
            /// <summary>null, with a capacity of 0: count only</summary>
            public Penetration* Penetrations;
            public UIntPtr PenetrationCapacity;
            public UIntPtr PenetrationCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct Body  // sc_body
        {
            /// <summary>open, with triangles; a character, or what `bake --prop` wrote</summary>
            public Asset* Asset;
            /// <summary>as of an sc_skin_contact_job; a prop has one bone</summary>
            public Pose Pose;
            /// <summary>from sc_prepare_skin(), of this asset</summary>
            public ulong* SkinTable;
            /// <summary>bit p: body part p meets nothing; null: all parts meet</summary>
            public ulong* IgnoredParts;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct SceneBody  // sc_scene_body
        {
            /// <summary>refitted; or null: the box counts</summary>
            public Sphere* Spheres;
            public UIntPtr SphereCount;
            public Vec3 Low;
            /// <summary>without spheres: a box around the body, as sc_bound_body() has it; finite</summary>
            public Vec3 High;
            public JointTransform* Transform;
            /// <summary>below 32</summary>
            public uint Layer;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct SceneJob  // sc_scene_job
        {
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

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct BodyContactJob  // sc_body_contact_job
        {
            public Body A;
            public Body B;
            /// <summary>the same contacts on every one</summary>
            public Target Target;
            /// <summary>1: find pairs of spheres alone; each ends at its first contact. Cheapest</summary>
            public int SpheresOnly;
            /// <summary>sc_body_scratch_words() words; nothing is kept there between runs</summary>
            public ulong* Scratch;
            public UIntPtr ScratchWords;
            public PartContact* Parts;
            public UIntPtr PartCapacity;
            public Pair* Spheres;
            public UIntPtr SphereCapacity;
            public TriangleContact* Triangles;
            public UIntPtr TriangleCapacity;
            public UIntPtr PartCount;
            public UIntPtr SphereCount;
            public UIntPtr TriangleCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct BodyPenetrationJob  // sc_body_penetration_job
        {
            public Body A;
            /// <summary>ignored_parts is not read</summary>
            public Body B;
            public Target Target;
            /// <summary>null: none</summary>
            public TriangleContact* Contacts;
            public UIntPtr ContactCount;
            /// <summary>null: none</summary>
            public Penetration* Previous;
            public UIntPtr PreviousCount;
            public int Quick;
            public float TouchDepth;
            /// <summary>sc_body_penetration_scratch_words() words; nothing is kept there between runs</summary>
            public ulong* Scratch;
            public UIntPtr ScratchWords;
            /// <summary>out: sorted by (part_a, part_b)</summary>
            public Penetration* Penetrations;
            public UIntPtr PenetrationCapacity;
            public UIntPtr PenetrationCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct FloorJob  // sc_floor_job
        {
            public Body Body;
            /// <summary>the same bits on every one</summary>
            public Target Target;
            /// <summary>of unit length</summary>
            public Vec3 Up;
            /// <summary>of the plane: up . p = height on it</summary>
            public float Height;
            public IntPtr Terrain;
            public void* User;
            /// <summary>as of an sc_penetration_job</summary>
            public float TouchDepth;
            /// <summary>sc_floor_scratch_words() words; nothing is kept there between runs</summary>
            public ulong* Scratch;
            public UIntPtr ScratchWords;
            /// <summary>out: sorted by part_b; null, with a capacity of 0: count only</summary>
            public Penetration* Penetrations;
            public UIntPtr PenetrationCapacity;
            public UIntPtr PenetrationCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct CrowdJob  // sc_crowd_job
        {
            public Asset* Asset;
            /// <summary>below 2^32</summary>
            public UIntPtr InstanceCount;
            /// <summary>bones of instance 0; morph weights are not read; no vertices</summary>
            public Pose Pose;
            /// <summary>or the spheres of instance 0, of refits with the same radius</summary>
            public Sphere* Spheres;
            public UIntPtr InstanceStride;
            public Radius Radius;
            public Target Target;
            public Filter* Filter;
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
            /// <summary>out: sorted by instance, then pair; or null. What lies past pair_count is written too. With several tasks leave room for twice the pairs, or it takes a second pass</summary>
            public CrowdPair* Pairs;
            public UIntPtr PairCapacity;
            /// <summary>out: how many there are, also where `pairs` is too small</summary>
            public UIntPtr PairCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct RefitJob  // sc_refit_job
        {
            /// <summary>open</summary>
            public Asset* Asset;
            /// <summary>bones or vertices</summary>
            public Pose Pose;
            public Radius Radius;
            public Target Target;
            /// <summary>out: the asset's, in its order; in the pose's space</summary>
            public Sphere* Spheres;
            public UIntPtr SphereCapacity;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct Motion  // sc_motion
        {
            public Body Body;
            public Pose End;
            public Blend Blend;
            public JointTransform* StartJoints;
            public JointTransform* EndJoints;
            /// <summary>at most 65536</summary>
            public UIntPtr JointCount;
            /// <summary>of a joint an earlier one, or SC_NO_JOINT; null: of all SC_NO_JOINT</summary>
            public uint* Parents;
            /// <summary>of each bone of the asset: sc_bind_joints(); null: joint b moves bone b</summary>
            public uint* JointOfBone;
        }

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct StepJob  // sc_step_job
        {
            public Motion A;
            public Motion B;
            /// <summary>the same contacts, and times, on every one</summary>
            public Target Target;
            /// <summary>of one body; null: the asset's ignored pairs</summary>
            public Filter* Filter;
            /// <summary>a share of the height of a's asset; 0: 0.0001</summary>
            public float Tolerance;
            /// <summary>sc_step_scratch_words() words; nothing is kept there between runs</summary>
            public ulong* Scratch;
            public UIntPtr ScratchWords;
            public StepContact* Contacts;
            public UIntPtr ContactCapacity;
            /// <summary>out: how many there are, also where `contacts` is too small</summary>
            public UIntPtr ContactCount;
        }

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern byte* sc_code_text(Code code);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern byte* sc_field_name(Field field);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern byte* sc_target_name(Target target);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Target* sc_supported_targets(UIntPtr* count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern uint sc_abi_version();

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_asset_open(Asset* asset, uint abi, void* data, UIntPtr size, byte* message, UIntPtr message_size);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int sc_asset_is_open(Asset* asset);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern AssetInfo sc_asset_get_info(Asset* asset);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern RestSphere sc_asset_sphere(Asset* asset, UIntPtr index);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Bone sc_asset_bone(Asset* asset, UIntPtr index);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Part sc_asset_part(Asset* asset, UIntPtr index);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern byte* sc_asset_morph_name(Asset* asset, UIntPtr index);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern byte* sc_asset_region_name(Asset* asset, UIntPtr index);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern SourceBuffer sc_asset_source_buffer(Asset* asset, UIntPtr index);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern ulong sc_hash_positions(float* positions, UIntPtr count, UIntPtr stride);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_check_source(Asset* asset, UIntPtr buffer, float* positions, UIntPtr count, UIntPtr stride);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_detect(DetectJob* job);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_pair_words(Asset* asset);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_detect_table_words(Asset* asset);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_prepare_detect(Asset* asset, Radius radius, Filter* filter, ulong* words, UIntPtr word_count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_reset_filter(Asset* asset, Filter* filter);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_ignore_pair(Asset* asset, Filter* filter, uint a, uint b, int ignored);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_ignore_regions(Asset* asset, Filter* filter, UIntPtr region, UIntPtr other, int ignored);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_bind_joints(Asset* asset, Bone* joints, UIntPtr joint_count, MatrixLayout inverse_bind_layout, uint* joint_of_bone, UIntPtr capacity, byte* message, UIntPtr message_size);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_gather_bones(Asset* asset, uint* joint_of_bone, Pose* palette, float* bones);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_place_bones(JointTransform* transform, float* bones, UIntPtr bone_count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_check_rest_pose(Asset* asset, Pose* pose, byte* message, UIntPtr message_size);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_find_skin_contacts(SkinContactJob* job);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_skin_table_words(Asset* asset);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_prepare_skin(Asset* asset, ulong* words, UIntPtr word_count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_skin_scratch_words(Asset* asset);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_measure_penetrations(PenetrationJob* job);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_penetration_scratch_words(Asset* asset, UIntPtr contact_count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern byte* sc_penetration_class_name(PenetrationClass kind);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_find_body_contacts(BodyContactJob* job);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_body_scratch_words(Asset* a, Asset* b);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_measure_body_penetrations(BodyPenetrationJob* job);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_body_penetration_scratch_words(Asset* a, Asset* b, UIntPtr contact_count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_find_floor_penetrations(FloorJob* job);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_floor_scratch_words(Asset* asset);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_bound_body(Body* body, Vec3* low, Vec3* high);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_find_meetings(SceneJob* job);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_scene_scratch_words(UIntPtr body_count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_part_words(Asset* asset);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_character_create(uint abi, void* data, UIntPtr size, Bone* joints, UIntPtr joint_count, MatrixLayout inverse_bind_layout, IntPtr* character, byte* message, UIntPtr message_size);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern void sc_character_destroy(IntPtr character);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Asset* sc_character_asset(IntPtr character);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_character_check_rest(IntPtr character, Pose* palette, byte* message, UIntPtr message_size);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_character_contacts(IntPtr character, Pose* palette, PartContact** contacts, UIntPtr* count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_character_penetrations(IntPtr character, Pose* palette, Penetration** penetrations, UIntPtr* count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_detect_crowd(CrowdJob* job);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_crowd_scratch_words(Asset* asset, UIntPtr task_count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_refit(RefitJob* job);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern Status sc_find_step_contacts(StepJob* job);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr sc_step_scratch_words(Motion* a, Motion* b);
    }
}
